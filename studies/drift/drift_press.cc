#include "studies/drift/drift_press.h"

#include <array>
#include <cmath>

#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

struct ProductMotion {
  double speed, low, high;  ///< m/s, Pa, Pa
};
constexpr std::array<ProductMotion, StrokePress::kProducts> kMotions = {
    {{0.045, 60e5, 120e5}, {0.07, 90e5, 170e5}, {0.1, 120e5, 205e5}}};
constexpr double kForty = 313.15;
constexpr double kGrade = 32.0;                    ///< mm^2/s at 40 degC, of the simulated oil
constexpr double kSecondsOfSlowStroke = 8.0;       ///< enough for the slowest product
constexpr double kHealthyLeak = 0.05 / 6e4 / 2e7;  ///< m^3/(s Pa)

}  // namespace

bool WasTold(const drift::DriftFinding& finding) {
  return finding.state == drift::FindingState::kNamed || finding.state == drift::FindingState::kUndecided;
}

PressOptions ProductOptions(int product, std::uint64_t seed) {
  PressOptions o;
  o.seed = seed;
  o.motion.speed_min = 0.97 * kMotions[product].speed;
  o.motion.speed_max = 1.03 * kMotions[product].speed;
  o.motion.set_point_min = kMotions[product].low;
  o.motion.set_point_max = kMotions[product].high;
  return o;
}

Result<StrokePress> StrokePress::Create(int strokes, std::uint64_t seed) {
  StrokePress press(seed);
  for (int product = 0; product < kProducts; ++product) {
    PressOptions options = ProductOptions(product, StreamSeed(seed, "product") + product);
    options.seconds = strokes * kSecondsOfSlowStroke;
    const auto log = TRY(StrokesOf(SimulatePress(options), MachineFor(options)));
    if (!press.model_) {
      auto model = TRY(drift::WatchedModel::Create(log.model, {"internal_leakage"}));
      press.model_ = std::make_shared<const drift::WatchedModel>(std::move(model));
      press.machine_ = options.machine;
      const double q = options.machine.Q_vn / std::sqrt(options.machine.dp_nom), a = options.machine.A_A;
      press.theta_ = Eigen::VectorXd::Zero(press.model_->size());
      press.theta_.head(4) << -q, -options.machine.V0 / options.machine.K, -a / options.machine.K,
          q * options.machine.y_0;
    }
    ProductStrokes p;
    std::vector<Eigen::VectorXd> errors;
    for (const StrokeRecord& record : log.strokes) {
      p.strokes.push_back(press.model_->Evidence(record, 0));
      const NormalEquations& e = p.strokes.back().equations;
      errors.push_back((e.g - e.h * press.theta_).cwiseQuotient(e.h.diagonal().cwiseSqrt()));
    }
    const int n = press.model_->size();
    p.mean = Eigen::VectorXd::Zero(n);
    for (const auto& error : errors) p.mean += error / static_cast<double>(errors.size());
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
    for (const auto& error : errors)
      covariance += (error - p.mean) * (error - p.mean).transpose() / static_cast<double>(errors.size() - 1);
    const SymmetricEigen eigen = EigenOf(covariance);
    p.shape = eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
    press.products_.push_back(std::move(p));
  }
  return press;
}

void StrokePress::Start(std::uint64_t seed) {
  random_ = RandomStream(seed);
  sequence_ = 0;
  wander_bulk_ = wander_null_ = ambient_ = load_ = 0;
  left_ = 0;
}

int StrokePress::Product() {
  if (left_-- <= 0) {
    product_ = (product_ + 1 + static_cast<int>(random_.Uniform(0, 2))) % kProducts;
    left_ = static_cast<int>(random_.Uniform(150, 500));
  }
  return product_;
}

double StrokePress::OilTemperature(std::int64_t stroke) {
  const auto of_day = static_cast<double>(stroke % kStrokesPerDay);
  if (of_day == 0) {
    ambient_ = 2.0 * random_.Normal();
    wander_bulk_ = 0.7 * wander_bulk_ + 0.0025 * random_.Normal();
    wander_null_ = 0.7 * wander_null_ + 1e-4 * random_.Normal();
  }
  load_ = 0.995 * load_ + 0.1 * 1.5 * random_.Normal();
  const double warm = 62 + load_ + ambient_, cold = 20 + ambient_;
  return 273.15 + warm - (warm - cold) * std::exp(-of_day / 300.0);
}

drift::StrokeEvidence StrokePress::Next(double oil_temperature, int product, const PressFault& fault) {
  const ProductStrokes& p = products_[product];
  const auto pick = static_cast<std::size_t>(random_.Uniform(0, static_cast<double>(p.strokes.size())));
  drift::StrokeEvidence stroke = p.strokes[std::min(pick, p.strokes.size() - 1)];
  stroke.sequence = sequence_++;
  stroke.time = 5.0 * static_cast<double>(stroke.sequence);
  stroke.oil_temperature = oil_temperature + 0.05 * random_.Normal();
  const double warmth = oil_temperature - kForty, thick = drift::RelativeViscosity(oil_temperature, kGrade);
  const double bulk = machine_.K * (1 - 0.002 * warmth) * (1 + wander_bulk_) * (1 + fault.bulk_modulus);
  const double flow = machine_.Q_vn * (1 - 0.04 * (thick - 1)) * (1 + fault.flow);
  const double null = machine_.y_0 + 1e-5 * warmth + wander_null_ + fault.null;
  const double q = flow / std::sqrt(machine_.dp_nom);
  Eigen::VectorXd theta(model_->size());
  theta << -q, -machine_.V0 / bulk, -machine_.A_A / bulk, q * null, (kHealthyLeak + fault.leakage) / thick;
  Eigen::VectorXd draw(model_->size());
  for (double& d : draw) d = random_.Normal();
  const double factor = random_.Uniform() < 1e-3 ? 10.0 : 1.0;
  NormalEquations& e = stroke.equations;
  const double noise = factor * factor * std::max(0.0, e.yy - 2 * e.g.dot(theta_) + theta_.dot(e.h * theta_));
  e.g = e.h * theta + (p.mean + factor * (p.shape * draw)).cwiseProduct(e.h.diagonal().cwiseSqrt());
  e.yy = 2 * e.g.dot(theta) - theta.dot(e.h * theta) + noise;
  return stroke;
}

}  // namespace hydroscope
