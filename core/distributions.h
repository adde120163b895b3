#pragma once

namespace hydroscope {

// Quantiles and tails of the distributions that hypotheses are tested with (boost::math, compiled once), in double: boost's
// default of long double takes ten times as long. Errors: std::domain_error for degrees of freedom or probabilities that
// cannot be.

/// Value that a standard normal variable exceeds with this probability.
double NormalExceededWith(double probability);

/// Value below which Student's t of these degrees of freedom lies with this probability.
double StudentQuantile(double probability, double degrees);
/// Half width of a 95 % interval in standard errors of these degrees of freedom.
double StudentHalfWidth95(double degrees);
/// Probability of a |t| beyond this one.
double StudentTwoSided(double t, double degrees);

double ChiSquaredQuantile(double probability, double degrees);
/// Probability of less than `x`, and of more.
double ChiSquaredBelow(double x, double degrees);
double ChiSquaredAbove(double x, double degrees);

/// Probability of an F beyond this one.
double FisherAbove(double f, double numerator_degrees, double denominator_degrees);

}  // namespace hydroscope
