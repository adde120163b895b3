#include "estimation/closed_loop/open_parameters.h"

namespace hydroscope {
namespace {

constexpr double kCoherent = 0.8;      // coherence from which on the output follows the set point, ...
constexpr double kFewCoherent = 0.05;  // ... at so few of the frequencies: it hardly does
constexpr double kHighestShare = 0.9;  // share of the highest frequency, beyond which the highest begin
constexpr double kNearlyAll = 0.35;    // of the sampling rate: what rows can show hardly reaches further

}  // namespace

Told WhyParametersStayOpen(const LoopSpectra& spectra, const std::vector<std::size_t>& used,
                           const TransferFit& fit) {
  std::size_t coherent = 0, high = 0, high_coherent = 0;
  double up_to = 0;
  for (const std::size_t bin : used) {
    const double frequency = spectra.Frequency(bin);
    const bool is_high = frequency > kHighestShare * fit.highest;
    high += is_high;
    if (spectra.bins[bin].CoherenceOfOutput() < kCoherent) continue;
    ++coherent;
    high_coherent += is_high;
    up_to = frequency;
  }
  const Told what =
      Tell("the frequencies from {:.4g} to {:.4g} Hz do not determine the parameters",
           "die Frequenzen von {:.4g} bis {:.4g} Hz bestimmen die Parameter nicht", fit.lowest, fit.highest);
  if (static_cast<double>(coherent) < kFewCoherent * static_cast<double>(used.size()))
    return Tell(
        "{}: the output follows the set point at {} of {} of them alone, noise covers it at the others. Excite the set point more "
        "strongly, or record for longer",
        "{}: der Ausgang folgt dem Sollwert nur bei {} von {} von ihnen, bei den anderen verdeckt ihn Rauschen. Den Sollwert stärker "
        "anregen oder länger aufzeichnen",
        what, coherent, used.size());
  if (fit.highest > kNearlyAll / spectra.sample_period && 2 * high_coherent > high)
    return Tell(
        "{}: the output still follows the set point at the highest that rows {:.3g} ms apart show, and what is beyond counts too. "
        "Record rows faster",
        "{}: der Ausgang folgt dem Sollwert noch bei den höchsten, die Zeilen im Abstand von {:.3g} ms zeigen, und was darüber liegt, "
        "zählt mit. Zeilen schneller aufzeichnen",
        what, 1e3 * spectra.sample_period);
  if (fit.inflation > 1)
    return Tell(
        "{}: the response is none that this transfer function can have, the nearest lies {:.2g} times the noise beside it. A "
        "resonance that the plant is not known to have (--to leaves out what lies above), dry friction (larger movements make it "
        "matter less) or movements too large for a linear valve do that; exciting more frequencies does not help",
        "{}: die Antwort ist keine, die diese Übertragungsfunktion haben kann, die nächste liegt um das {:.2g}fache des Rauschens "
        "daneben. Eine Resonanz, die von der Strecke nicht bekannt ist (--to lässt weg, was darüber liegt), trockene Reibung (bei "
        "größeren Bewegungen zählt sie weniger) oder zu große Bewegungen tun das; mehr Frequenzen helfen nicht",
        what, fit.inflation);
  return Tell(
      "{}: the output follows the set point up to {:.4g} Hz, and there it shows a part of the transfer function alone. Where dry "
      "friction holds it, larger movements show more; else excite a wider range",
      "{}: der Ausgang folgt dem Sollwert bis {:.4g} Hz und zeigt dort nur einen Teil der Übertragungsfunktion. Wo ihn trockene "
      "Reibung hält, zeigen größere Bewegungen mehr; sonst einen weiteren Bereich anregen",
      what, up_to);
}

}  // namespace hydroscope
