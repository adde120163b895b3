#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "core/result.h"
#include "diagnosis/drift/drift_monitor.h"
#include "diagnosis/drift/watched_model.h"
#include "simulator/random.h"
#include "studies/simulated_strokes.h"

namespace hydroscope {

/// What is wrong with the simulated press, as it stands at one stroke.
struct PressFault {
  double bulk_modulus = 0;  ///< relative change of K'
  double flow = 0;          ///< relative change of Q_vn
  double null = 0;          ///< change of y_0
  double leakage = 0;       ///< m^3/(s Pa), internal
};

inline constexpr double kOneLitre = 1 / 6e4 / 2e7;                         ///< m^3/(s Pa): 1 l/min at 200 bar
inline constexpr double kNever = std::numeric_limits<double>::infinity();  ///< strokes to what did not happen

/// Whether a person would hear of it.
bool WasTold(const drift::DriftFinding& finding);

/// A product's strokes, fully simulated once: their information and how their equations scatter about the truth.
struct ProductStrokes {
  std::vector<drift::StrokeEvidence> strokes;
  Eigen::VectorXd mean;   ///< of the scores at the truth, each over the root of its own information
  Eigen::MatrixXd shape;  ///< lower Cholesky factor of their covariance
};

/// Strokes of a press at the level of normal equations, for campaigns of years: the information of a stroke
/// is taken from fully simulated ones of the same product, its error drawn with the covariance that these
/// show about the truth. Healthy behaviour: K' falls by 0.2 %/K, Q_vn follows the viscosity of an ISO VG 32
/// oil (not the grade the model assumes), a good seal leaks 0.05 l/min at 200 bar and 40 degC with the
/// viscosity, K' and y_0 wander from day to day, and one stroke in a thousand is ten times as noisy.
class StrokePress {
 public:
  static constexpr int kProducts = 3;
  static constexpr int kStrokesPerDay = 1500;

  /// Simulates `strokes` of each product in full.
  static Result<StrokePress> Create(int strokes, std::uint64_t seed);
  /// A press of its own: other days, same products.
  void Start(std::uint64_t seed);
  /// Next stroke at this oil temperature (K) with product and fault given.
  drift::StrokeEvidence Next(double oil_temperature, int product, const PressFault& fault);
  /// Oil temperature of the day's stroke: 20 degC in the morning, up to some 65 degC, wandering with the load.
  double OilTemperature(std::int64_t stroke);
  /// Product of this stroke: changed every 150 ... 500 strokes.
  int Product();

  const drift::WatchedModel& model() const { return *model_; }
  RandomStream& random() { return random_; }

 private:
  explicit StrokePress(std::uint64_t seed) : random_(seed) {}
  std::shared_ptr<const drift::WatchedModel> model_;
  std::vector<ProductStrokes> products_;
  RandomStream random_;
  Eigen::VectorXd theta_;  ///< of the healthy press at 40 degC, all watched columns
  PressMachine machine_;
  std::int64_t sequence_ = 0;
  double wander_bulk_ = 0, wander_null_ = 0, ambient_ = 0, load_ = 0;
  int product_ = 0, left_ = 0;
};

/// Options of a fully simulated log of one product.
PressOptions ProductOptions(int product, std::uint64_t seed);

}  // namespace hydroscope
