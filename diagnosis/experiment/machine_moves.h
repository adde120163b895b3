#pragma once

#include <span>

#include "diagnosis/refine.h"
#include "estimation/stroke_accumulator.h"
#include "models/machine.h"

namespace hydroscope {

/// What the machine may be asked to do, and what it does when nothing is asked.
struct MachineMoves {
  double speed_min = 0.02, speed_max = 0.12;         ///< m/s, ram speeds
  double pressure_min = 40e5, pressure_max = 200e5;  ///< Pa, cushion pressures
  double rod_min = 60e5, rod_max = 60e5;  ///< Pa, pressures of chamber B; equal = not to be changed
  double stroke = 0.19;                   ///< m
  double min_opening = 0.0;               ///< spool position below which the gate shuts
  double warm_up = 0.0;                   ///< K by which the oil may warm between strokes; 0 = not
  int max_strokes = 400;                  ///< longest series worth asking for

  double rod = 60e5, supply = 210e5;  ///< Pa, chamber B and supply as recorded, medians
  double oil = 313.15;                ///< K, as recorded, median
  double p_noise = 0, z_noise = 0,
         y_noise = 0;  ///< Pa, m, 1: std of the sensor noise as recorded, white part
};

/// The limits the machine file gives; what it leaves out is taken from the strokes recorded.
MachineMoves MovesOf(const Machine& machine, std::span<const StrokeStretches> strokes);

}  // namespace hydroscope
