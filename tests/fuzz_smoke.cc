// Runs a libFuzzer target without libFuzzer, for a few seconds, so that every build does it: files given as
// arguments and byte strings made from them by chance (flipped, cut, repeated, joined). scripts/fuzz.sh does
// it better and longer.
//   X_smoke SECONDS [FILE...]
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kLongest = 16384;

Bytes Changed(Bytes bytes, const std::vector<Bytes>& seeds, std::mt19937_64& random) {
  for (std::uint64_t changes = 1 + random() % 8; changes > 0; --changes) {
    const std::size_t at = bytes.empty() ? 0 : random() % bytes.size();
    const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const Bytes& other = seeds[random() % seeds.size()];
    switch (random() % 6) {
      case 0:
        if (!bytes.empty()) *place = static_cast<std::uint8_t>(random());
        break;
      case 1:
        if (!bytes.empty()) *place = static_cast<std::uint8_t>(*place ^ (1u << (random() % 8)));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.insert(place, static_cast<std::size_t>(random() % 16), static_cast<std::uint8_t>(random()));
        break;
      case 4:
        bytes.insert(place, other.begin(),
                     other.begin() + static_cast<std::ptrdiff_t>(random() % (other.size() + 1)));
        break;
      default:
        bytes.erase(place, place + static_cast<std::ptrdiff_t>(random() % (bytes.size() - at + 1)));
    }
    bytes.resize(std::min(bytes.size(), kLongest));
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 5;
  std::vector<Bytes> seeds = {{}, Bytes(64, 0), Bytes(512, 1)};
  for (int i = 2; i < argc; ++i) {
    std::ifstream file(argv[i], std::ios::binary);
    if (!file) {
      std::fprintf(stderr, "%s cannot be read\n", argv[i]);
      return 2;
    }
    seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  for (const Bytes& seed : seeds) LLVMFuzzerTestOneInput(seed.data(), seed.size());
  std::mt19937_64 random(1);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  std::int64_t inputs = 0;
  for (; std::chrono::steady_clock::now() < end; ++inputs) {
    const Bytes input = Changed(seeds[random() % seeds.size()], seeds, random);
    LLVMFuzzerTestOneInput(input.data(), input.size());
  }
  std::printf("%lld inputs\n", static_cast<long long>(inputs));
  return inputs > 0 ? 0 : 1;
}
