#pragma once

#include <Eigen/Dense>
#include <optional>
#include <span>

#include "diagnosis/extended_fit.h"
#include "models/stretch.h"

namespace hydroscope {

/// A coherent tone in what a model leaves, as a flow: amplitude sin(2 pi frequency t + phase), t as Stretch::begin counts it.
struct Tone {
  double frequency = 0;  ///< Hz
  double phase = 0;      ///< rad, -pi ... pi
  double amplitude = 0;  ///< output unit
};

/// Looks for a tone that keeps its phase all through the log in what `weights . columns` leave of the output
/// (ColumnWeights). It must stand above the neighbouring frequencies by what chance gives once in a thousand
/// logs (periodogram against its local median, Priestley 1981, sec. 6.1.4), and keep the time of the log, not
/// that of the strokes: what every stroke repeats since its beginning is no tone. Nothing if there is none.
std::optional<Tone> FindTone(const ModelStructure& model, std::span<const StrokeStretches> strokes,
                             const Eigen::VectorXd& weights);

/// The shapes of effects that no grid holds (Effect::grid empty): their values are searched for in what
/// `weights` leave. True if one was added.
bool AddSearchedShapes(ModelStructure& model, std::span<const StrokeStretches> strokes,
                       const Eigen::VectorXd& weights);

}  // namespace hydroscope
