// CSV reader, extrema pairing and decay fit against plain loops, in one run. CPU time, best of five.

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <vector>

#include "hil/base/rng.h"
#include "hil/trace/csv.h"
#include "hil/trace/decay_fit.h"
#include "hil/trace/extrema.h"
#include "tests/speed/best_of.h"

namespace {

using forcegate::Rng;
using forcegate::speed::sink;

template <class Work>
double best_of_five(Work work) {
  return forcegate::speed::best_cpu_s(5, work);
}

/// The limit: mapped file, std::from_chars, five columns known beforehand.
void bare_csv(const char* path) {
  const int fd = ::open(path, O_RDONLY);
  struct stat status;
  ::fstat(fd, &status);
  const auto size = static_cast<std::size_t>(status.st_size);
  char* map = static_cast<char*>(::mmap(nullptr, size, PROT_READ, MAP_PRIVATE | MAP_POPULATE, fd, 0));
  const char *p = map, *end = map + size;
  p = static_cast<const char*>(std::memchr(p, '\n', size)) + 1;
  std::vector<double> columns[5];
  for (auto& c : columns) c.reserve(1300000);
  while (p < end)
    for (auto& c : columns) {
      double x = 0.0;
      p = std::from_chars(p, end, x).ptr + 1;
      c.push_back(x);
    }
  sink = columns[4].back();
  ::munmap(map, size);
  ::close(fd);
}

void csv() {
  const auto path =
      std::filesystem::temp_directory_path() / ("forcegate_speed_" + std::to_string(::getpid()) + ".csv");
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file) return;
  Rng rng(1, "csv");
  std::fputs("t,F,U,T,theta\n", file);
  for (int i = 0; i < 1200000; ++i) {
    const double force = 5 - 5 * std::cos(i * 1.5707963e-3);
    std::fprintf(file, "%.6f,%.6f,%.6f,%.6f,%.6f\n", i * 1e-3, force,
                 0.35 + 0.22 * force + rng.normal(0, 2e-3), 23 + 1e-6 * i, 9 * force + rng.normal(0, 0.05));
  }
  std::fclose(file);
  const double bare = best_of_five([&] { bare_csv(path.c_str()); });
  const double ours = best_of_five([&] {
    const auto read = forcegate::read_csv(path);
    sink = read ? read->trace.channels[3].value.back() : 0.0;
  });
  std::filesystem::remove(path);
  std::printf("csv      1.2 M rows x 5        bare from_chars %7.1f ms   ours %7.1f ms   ratio %.2f\n",
              bare * 1e3, ours * 1e3, ours / bare);
}

void extrema() {
  constexpr std::size_t n = 1200000, block = 500;
  std::vector<double> t(n);
  std::vector<float> guide(n), follower[3];
  Rng rng(2, "extrema");
  for (auto& f : follower) f.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    t[i] = static_cast<double>(i) * 1e-3;
    guide[i] = static_cast<float>(2 + std::sin(3.14159265358979 * t[i]));
    for (auto& f : follower) f[i] = 0.9f * guide[i] + static_cast<float>(rng.normal(0, 0.01));
  }
  const double bare = best_of_five([&] {  // per-cycle minima and maxima of known cycles
    double sum = 0.0;
    for (const auto& f : follower)
      for (std::size_t c = 0; c + 2000 <= n; c += 2000) {
        float low = f[c], high = f[c];
        for (std::size_t i = c; i < c + 2000; ++i) low = std::min(low, f[i]), high = std::max(high, f[i]);
        sum += static_cast<double>(low + high);
      }
    sink = sum;
  });
  for (const int half_width : {0, 20}) {
    const double ours = best_of_five([&] {
      forcegate::ExtremaPairer pairer({.prominence = 0.2, .followers = 3, .half_width = half_width});
      for (std::size_t at = 0; at < n; at += block) {
        const float* columns[] = {&follower[0][at], &follower[1][at], &follower[2][at]};
        pairer.push(std::span(t).subspan(at, block), std::span<const float>(guide).subspan(at, block),
                    columns);
      }
      pairer.finish();
      sink = pairer.pairs().back().value[0];
    });
    std::printf(
        "extrema  3 followers, mean %2d   bare min/max    %7.2f ns   ours %7.2f ns a sample   ratio %.2f\n",
        2 * half_width + 1, bare / n * 1e9, ours / n * 1e9, ours / bare);
  }
}

void decay() {
  std::vector<double> t, u;
  Rng rng(3, "decay");
  for (int i = 0; i < 600; ++i) {
    t.push_back(2.0 * i);
    u.push_back(1.2 + 0.8 * std::exp(-0.0066 * t.back()) + rng.normal(0, 0.01));
  }
  const double bare = best_of_five([&] {  // 100 evaluations of the sum of squares
    double sum = 0.0;
    for (int k = 0; k < 100; ++k)
      for (std::size_t i = 0; i < t.size(); ++i) {
        const double r = u[i] - 1.2 - 0.8 * std::exp(-(0.006 + 1e-5 * k) * t[i]);
        sum += r * r;
      }
    sink = sum;
  });
  const double ours = best_of_five([&] {
    const auto fit = forcegate::fit_decay(t, u, 0.4);
    sink = fit ? fit->b_per_s : 0.0;
  });
  std::printf("decay    600 maxima             100 passes      %7.1f us   ours %7.1f us   ratio %.2f\n",
              bare * 1e6, ours * 1e6, ours / bare);
}

}  // namespace

int main() {
  csv();
  extrema();
  decay();
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  std::printf("peak memory %.0f MB\n", static_cast<double>(usage.ru_maxrss) / 1024.0);
}
