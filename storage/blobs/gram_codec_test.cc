#include "storage/blobs/gram_codec.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;
using testing::HasSubstr;

StrokeGram Sample(int dimension = 5) { return MakeStroke(3, dimension).gram; }

TEST(GramCodec, CountsIntegralAndFlowComeBackToTheBit) {
  for (const int dimension : {0, 1, 5, 45}) {
    const StrokeGram gram = Sample(dimension);
    const StrokeGram back = Value(DecodeGram(EncodeGram(gram, NoisePrecision::kFloat)));
    EXPECT_EQ(back.blocks, gram.blocks);
    EXPECT_EQ(back.spans, gram.spans);
    EXPECT_EQ(back.windows, gram.windows);
    EXPECT_EQ(back.integral, gram.integral);
    EXPECT_EQ(back.flow, gram.flow);
  }
}

TEST(GramCodec, NoiseKeepsSevenDigitsWhateverTheUnitsOfTheColumns) {
  StrokeGram gram = Sample(4);
  const double scale[] = {1e-30, 1e25, 1, 1e-3};  // squares leave the range of float32
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i <= j; ++i) gram.noise(i, j) *= scale[i] * scale[j];
  const StrokeGram back = Value(DecodeGram(EncodeGram(gram, NoisePrecision::kFloat)));
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i <= j; ++i)
      EXPECT_NEAR(back.noise(i, j), gram.noise(i, j), 6e-8 * std::abs(gram.noise(i, j))) << i << ", " << j;
}

TEST(GramCodec, ColumnsWithoutNoiseStayZero) {
  StrokeGram gram = Sample(3);
  for (int i = 0; i < 3; ++i) gram.noise(i, 1) = 0;
  const StrokeGram back = Value(DecodeGram(EncodeGram(gram, NoisePrecision::kFloat)));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(back.noise(i, 1), 0);
}

TEST(GramCodec, SumsKeepTheNoiseToTheBit) {
  const StrokeGram gram = Sample();
  EXPECT_EQ(Value(DecodeGram(EncodeGram(gram, NoisePrecision::kDouble))).noise, gram.noise);
}

TEST(GramCodec, EncodingAgainGivesTheSameBytes) {
  const auto bytes = EncodeGram(Sample(), NoisePrecision::kFloat);
  EXPECT_EQ(EncodeGram(Value(DecodeGram(bytes)), NoisePrecision::kFloat), bytes);
}

TEST(GramCodec, EveryCutOffBlobIsAnError) {
  const auto bytes = EncodeGram(Sample(), NoisePrecision::kFloat);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(DecodeGram(std::span(bytes).first(size)).has_value()) << size;
}

TEST(GramCodec, EveryFlippedBitIsAnError) {
  auto bytes = EncodeGram(Sample(), NoisePrecision::kFloat);
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= 1u << (bit % 8);
    EXPECT_FALSE(DecodeGram(bytes).has_value()) << bit;
    bytes[bit / 8] ^= 1u << (bit % 8);
  }
}

TEST(GramCodec, ErrorsSayWhatIsWrong) {
  auto bytes = EncodeGram(Sample(), NoisePrecision::kFloat);
  EXPECT_THAT(DecodeGram({}).error().text, HasSubstr("torn: 0 bytes"));
  EXPECT_THAT(DecodeGram(std::span(bytes).first(100)).error().text, HasSubstr("torn: 100 bytes"));
  bytes[60] ^= 1;
  EXPECT_THAT(DecodeGram(bytes).error().text, HasSubstr("checksum"));
  bytes[4] = 2;
  EXPECT_THAT(DecodeGram(bytes).error().text, HasSubstr("layout version 2"));
  bytes[0] = 'x';
  EXPECT_THAT(DecodeGram(bytes).error().text, HasSubstr("not a Gram"));
}

TEST(GramCodec, ADamagedGramInAFileIsAnErrorNamingRunAndStroke) {
  const Folder folder;
  Press press(folder.File());
  EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, 8)));
  {
    SQLite::Database db(folder.File(), SQLite::OPEN_READWRITE);
    db.exec("UPDATE gram SET gram = zeroblob(length(gram)) WHERE stroke = 5");
  }
  for (const std::string& text : {press.database.Grams(press.machine, 0, 8).error().text,
                                  press.database.SumGrams(press.machine, 0, 8).error().text,
                                  press.database.CheckIntegrity().error().text})
    EXPECT_THAT(text, HasSubstr("run 1 (a.csv), stroke 5: Gram not a Gram"));
  EXPECT_OK(press.database.Grams(press.machine, 0, 5));
}

}  // namespace
}  // namespace hydroscope
