#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/records/sample_block.h"
#include "core/records/stroke_record.h"
#include "core/result.h"
#include "storage/raw_chunk.h"

namespace hydroscope {

/// What one step of the live service stores of a run.
struct LiveBatch {
  SampleBlock raw;                           ///< rows in the order the pipeline took them; perhaps none
  std::vector<StrokeRecord> strokes;         ///< completed within these rows
  std::vector<std::uint8_t> pipeline_state;  ///< behind the last stroke; empty: as stored before
  std::vector<std::uint8_t> sender_marks;    ///< newest rows of the senders taken; empty: as stored before
  std::int64_t rows_taken = 0;               ///< rows of the run the pipeline has taken, with these
};

/// A stroke with its Gram as the database keeps it.
struct PackedStroke {
  StrokeSummary summary;
  std::vector<Estimate> estimates;
  std::vector<std::uint8_t> gram;      ///< EncodeGram
  std::array<int, 3> dimensions = {};  ///< of the Gram's integral, noise and flow
};
PackedStroke Pack(const StrokeRecord& record);

/// The same as bytes, so that the thread that owns the database has nothing left to compute.
struct PackedBatch {
  Result<std::vector<RawChunk>> raw;  ///< the error: rows that cannot be stored
  std::int64_t rows = 0;              ///< in `raw`
  std::vector<PackedStroke> strokes;
  std::vector<std::uint8_t> pipeline_state, sender_marks;
  std::int64_t rows_taken = 0;
};
PackedBatch Pack(LiveBatch&& batch, ColumnPacker& packer);

}  // namespace hydroscope
