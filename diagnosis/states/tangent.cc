#include "diagnosis/states/tangent.h"

#include "estimation/column_products.h"
#include "estimation/decompositions.h"

namespace hydroscope {

RowMatrix TangentColumns(const StateFit& fit, const Episode& episode, std::size_t index,
                         const AddedTerms& added, const std::vector<const RowMatrix*>& errors) {
  const StateModel& model = *fit.model;
  const int states = model.states(), outputs = model.output.rows, parameters = model.parameter_count();
  StateSimulator simulator(fit.model);
  simulator.SetParameters(fit.parameters);
  std::vector<int> free;
  for (int i = 0; i < states; ++i)
    if (model.estimated[static_cast<std::size_t>(i)]) free.push_back(i);
  RowMatrix start = RowMatrix::Zero(states, parameters + static_cast<int>(free.size())), by_parameter;
  simulator.Initial(episode, fit.initial[index], &by_parameter);
  start.leftCols(parameters) = by_parameter;
  for (std::size_t k = 0; k < free.size(); ++k) start(free[k], parameters + static_cast<int>(k)) = 1;
  StateRun run;
  simulator.Run(episode, 0, episode.rows() - 1, fit.initial[index], &start, run,
                added.columns > 0 ? &added : nullptr);
  const Eigen::Index rows = run.slopes.rows();
  const auto last = static_cast<Eigen::Index>(errors.size());
  RowMatrix columns(rows, parameters + added.columns + last);
  columns.leftCols(parameters) = run.slopes.leftCols(parameters);
  for (std::size_t p = 0; p < fit.at_limit.size(); ++p)
    if (fit.at_limit[p]) columns.col(static_cast<Eigen::Index>(p)).setZero();
  columns.middleCols(parameters, added.columns) = run.slopes.rightCols(added.columns);
  RowMatrix local = run.slopes.middleCols(parameters, start.cols() - parameters);
  for (Eigen::Index r = 0; r < rows; ++r) {
    const Eigen::Index j = r % outputs;
    for (Eigen::Index k = 0; k < last; ++k)
      columns(r, columns.cols() - last + k) = (*errors[static_cast<std::size_t>(k)])(r / outputs, j);
    const bool good = columns.row(r).allFinite();
    if (!good) columns.row(r).setZero();
    columns.row(r) *= good ? 1 / fit.noise[j] : 0.0;
    local.row(r) *= good ? 1 / fit.noise[j] : 0.0;
  }
  if (local.cols() > 0) {
    const Eigen::MatrixXd basis = OrthonormalBasis(local);
    columns -= basis * (basis.transpose() * columns);
  }
  return columns;
}

std::vector<Eigen::MatrixXd> PieceProducts(const StateFit& fit, std::span<const Episode> episodes,
                                           const AddedTerms& added,
                                           const std::vector<const std::vector<RowMatrix>*>& errors) {
  const int outputs = fit.model->output.rows;
  std::vector<Eigen::MatrixXd> pieces;
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    std::vector<const RowMatrix*> own;
    for (const std::vector<RowMatrix>* error : errors) own.push_back(&(*error)[e]);
    const RowMatrix columns = TangentColumns(fit, episodes[e], e, added, own);
    for (const StatePiece& piece : fit.pieces) {
      if (piece.episode != static_cast<int>(e)) continue;
      const auto part = columns.middleRows(piece.first * outputs, (piece.last - piece.first) * outputs);
      pieces.push_back(ColumnProducts(part));
    }
  }
  return pieces;
}

}  // namespace hydroscope
