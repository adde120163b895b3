#include "core/distributions.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace hydroscope {
namespace {

using InDouble = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
using Normal = boost::math::normal_distribution<double, InDouble>;
using Student = boost::math::students_t_distribution<double, InDouble>;
using ChiSquared = boost::math::chi_squared_distribution<double, InDouble>;
using Fisher = boost::math::fisher_f_distribution<double, InDouble>;
using boost::math::complement;

}  // namespace

double NormalExceededWith(double probability) { return quantile(complement(Normal(), probability)); }

double StudentQuantile(double probability, double degrees) { return quantile(Student(degrees), probability); }
double StudentHalfWidth95(double degrees) { return StudentQuantile(0.975, degrees); }
double StudentTwoSided(double t, double degrees) {
  return 2 * cdf(complement(Student(degrees), std::abs(t)));
}

double ChiSquaredQuantile(double probability, double degrees) {
  return quantile(ChiSquared(degrees), probability);
}
double ChiSquaredBelow(double x, double degrees) { return cdf(ChiSquared(degrees), x); }
double ChiSquaredAbove(double x, double degrees) { return cdf(complement(ChiSquared(degrees), x)); }

double FisherAbove(double f, double numerator_degrees, double denominator_degrees) {
  return cdf(complement(Fisher(numerator_degrees, denominator_degrees), f));
}

}  // namespace hydroscope
