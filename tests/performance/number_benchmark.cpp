// Numbers of a text file: ours, which also counts their decimals for the output, beside the standard library
// and fast_float, which do not.
//   number_benchmark --benchmark_time_unit=ms
#include <benchmark/benchmark.h>

#include <charconv>
#include <random>
#include <string>
#include <vector>

#include "bespoke/number_format.h"
#include "bespoke/product/text/number_text.h"
#ifdef BESPOKE_HAS_FAST_FLOAT
#include <fast_float/fast_float.h>
#endif

namespace bespoke {
namespace {

constexpr int numbers_read = 1'000'000;

/// As OBJ files have them: six digits, or all of a double.
const std::vector<std::string>& number_texts(int digits) {
  static const auto make = [](int count) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> value(-100, 100);
    std::vector<std::string> texts;
    for (int i = 0; i < numbers_read; ++i) texts.push_back(format_number(value(random), count));
    return texts;
  };
  static const std::vector<std::string> few = make(6), all = make(17);
  return digits == 6 ? few : all;
}

template <class Read>
void read_all(benchmark::State& state, const Read& read) {
  const std::vector<std::string>& texts = number_texts(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    double sum = 0;
    for (const std::string& text : texts) sum += read(text.data(), text.data() + text.size());
    benchmark::DoNotOptimize(sum);
  }
}

void Ours(benchmark::State& state) {
  read_all(state, [](const char* begin, const char* end) {
    NumberText number;
    return read_number(begin, end, number) ? number.value + number.decimals : 0;
  });
}
BENCHMARK(Ours)->Arg(6)->Arg(17);

void StandardLibrary(benchmark::State& state) {
  read_all(state, [](const char* begin, const char* end) {
    double value = 0;
    std::from_chars(begin, end, value);
    return value;
  });
}
BENCHMARK(StandardLibrary)->Arg(6)->Arg(17);

#ifdef BESPOKE_HAS_FAST_FLOAT
void FastFloat(benchmark::State& state) {
  read_all(state, [](const char* begin, const char* end) {
    double value = 0;
    fast_float::from_chars(begin, end, value);
    return value;
  });
}
BENCHMARK(FastFloat)->Arg(6)->Arg(17);
#endif

}  // namespace
}  // namespace bespoke
