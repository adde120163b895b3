#include "pipeline/pipeline.h"

#include "models/machine_kind.h"
#include "pipeline/balance_pipeline.h"
#include "pipeline/episode_pipeline.h"

namespace hydroscope {

Result<std::unique_ptr<Pipeline>> Pipeline::Create(const Machine& machine, double sample_period,
                                                   RecordSink sink) {
  if (!(sample_period > 0))
    return BadInput("sample period is {} s, expected above 0: give [log] sample_period in the machine file",
                    sample_period);
  return InEpisodes(KindOf(machine)) ? EpisodePipeline::Create(machine, sample_period, std::move(sink))
                                     : BalancePipeline::Create(machine, sample_period, std::move(sink));
}

}  // namespace hydroscope
