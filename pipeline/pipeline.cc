#include "pipeline/pipeline.h"

#include "core/told_error.h"
#include "models/machine_kind.h"
#include "pipeline/balance_pipeline.h"
#include "pipeline/episode_pipeline.h"

namespace hydroscope {

Result<std::unique_ptr<Pipeline>> Pipeline::Create(const Machine& machine, double sample_period,
                                                   RecordSink sink) {
  if (!(sample_period > 0))
    return BadInput(
        Tell("sample period is {} s, expected above 0: give [log] sample_period in the machine file",
             "die Abtastzeit ist {} s, erwartet über 0: [log] sample_period in der Maschinendatei angeben",
             sample_period));
  return InEpisodes(KindOf(machine)) ? EpisodePipeline::Create(machine, sample_period, std::move(sink))
                                     : BalancePipeline::Create(machine, sample_period, std::move(sink));
}

}  // namespace hydroscope
