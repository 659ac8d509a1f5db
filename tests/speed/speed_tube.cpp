// Tube of two records of 1.2 M samples against a bare loop that slides a maximum and a minimum over the same
// window and counts samples outside; CPU time of both in one run, and their ratio.
//   speed_tube [repetitions, default 5]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "golden/compare/tube.h"
#include "hil/base/rng.h"

namespace {

double cpu_s() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Van Herk's sliding extrema over +-5 samples, whole arrays, constant tolerance.
std::size_t bare_tube(const std::vector<double>& r, const std::vector<double>& u) {
  const std::size_t h = 5, w = 2 * h + 1, n = r.size();
  std::vector<double> pm(n), sm(n), pl(n), sl(n);
  for (std::size_t b = 0; b < n; b += w) {
    const std::size_t e = std::min(n, b + w);
    pm[b] = pl[b] = r[b];
    for (std::size_t i = b + 1; i < e; ++i)
      pm[i] = std::max(pm[i - 1], r[i]), pl[i] = std::min(pl[i - 1], r[i]);
    sm[e - 1] = sl[e - 1] = r[e - 1];
    for (std::size_t i = e - 1; i-- > b;)
      sm[i] = std::max(sm[i + 1], r[i]), sl[i] = std::min(sl[i + 1], r[i]);
  }
  std::size_t outside = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t a = i < h ? 0 : i - h, z = std::min(n - 1, i + h);
    outside += u[i] > std::max(sm[a], pm[z]) + 0.05 || u[i] < std::min(sl[a], pl[z]) - 0.05;
  }
  return outside;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace forcegate;
  const int repetitions = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  const std::size_t n = 1200000;
  std::vector<float> g(n), x(n);
  Rng rng(1, "speed_tube");
  for (std::size_t i = 0; i < n; ++i) {
    g[i] = static_cast<float>(2.0 + 1.5 * std::sin(0.00314159 * static_cast<double>(i)));
    x[i] = g[i] + static_cast<float>(0.02 * rng.normal());
  }
  const std::vector<double> gd(g.begin(), g.end()), xd(x.begin(), x.end());
  TubeOptions options;
  options.absolute = 0.05;
  options.time_s = 0.005;
  options.lag_limit_s = 0.005;
  double ours = 1e9, bare = 1e9;
  std::size_t outside_ours = 0, outside_bare = 0;
  for (int i = 0; i < repetitions; ++i) {
    double t = cpu_s();
    outside_bare = bare_tube(gd, xd);
    bare = std::min(bare, cpu_s() - t);
    t = cpu_s();
    const auto r = compare_tube({0.0, 0.001, g}, {0.0, 0.001, x}, options);
    ours = std::min(ours, cpu_s() - t);
    if (!r) return 1;
    outside_ours = r->n_outside;
  }
  std::printf(
      "tube of 1.2 M samples: %.1f ms (coverage, lag, margins, spans), bare loop %.1f ms, ratio %.2f; outside %zu / %zu\n",
      1e3 * ours, 1e3 * bare, ours / bare, outside_ours, outside_bare);
  return outside_ours == outside_bare ? 0 : 1;
}
