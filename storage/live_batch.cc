#include "storage/live_batch.h"

#include <limits>

#include "storage/blobs/gram_codec.h"

namespace hydroscope {

PackedStroke Pack(const StrokeRecord& record) {
  const StrokeGram& gram = record.gram;
  return {record.summary,
          record.estimates,
          EncodeGram(gram, NoisePrecision::kFloat),
          {gram.integral.dimension(), gram.noise.dimension(), gram.flow.dimension()}};
}

PackedBatch Pack(LiveBatch&& batch, ColumnPacker& packer) {
  PackedBatch packed;
  packed.raw = PackRaw(batch.raw.time, batch.raw.signal, batch.raw.quality,
                       -std::numeric_limits<double>::infinity(), packer);
  packed.rows = static_cast<std::int64_t>(batch.raw.rows());
  for (const StrokeRecord& record : batch.strokes) packed.strokes.push_back(Pack(record));
  packed.pipeline_state = std::move(batch.pipeline_state);
  packed.sender_marks = std::move(batch.sender_marks);
  packed.rows_taken = batch.rows_taken;
  return packed;
}

}  // namespace hydroscope
