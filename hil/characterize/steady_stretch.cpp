#include "hil/characterize/steady_stretch.h"

#include <algorithm>
#include <set>

namespace forcegate::characterize {
namespace {

constexpr double kMostPeriodRatio = 2.0;

struct Point {
  double t_s, force_N;
  bool is_maximum;
};

std::vector<Point> in_order_of_time(const Extrema& e) {
  std::vector<Point> out;
  for (const Turns* t : {&e.maxima, &e.minima})
    for (std::size_t i = 0; i < t->size(); ++i) out.push_back({t->t_s[i], t->ati_N[i], t == &e.maxima});
  std::sort(out.begin(), out.end(), [](const Point& a, const Point& b) { return a.t_s < b.t_s; });
  return out;
}

double range_of(const std::multiset<double>& v) { return v.empty() ? 0.0 : *v.rbegin() - *v.begin(); }

// Turning points first..last of a run, kept sorted so that a step of either end costs a logarithm.
class Run {
 public:
  Run(const std::vector<Point>& points, double tolerance) : points_(points), tolerance_(tolerance) {}

  void push_back() {
    forces_of(end_).insert(points_[end_].force_N);
    if (end_ > begin_ + 1) periods_s_.insert(points_[end_].t_s - points_[end_ - 2].t_s);
    ++end_;
  }
  void pop_front() {
    std::multiset<double>& forces = forces_of(begin_);
    forces.erase(forces.find(points_[begin_].force_N));
    if (end_ - begin_ > 2) periods_s_.erase(periods_s_.find(points_[begin_ + 2].t_s - points_[begin_].t_s));
    ++begin_;
  }
  bool is_steady() const {
    if (end_ - begin_ < 2) return true;
    if (maxima_N_.empty() || minima_N_.empty()) return false;
    const double swing_N = *maxima_N_.rbegin() - *minima_N_.begin();
    return std::max(range_of(maxima_N_), range_of(minima_N_)) <= tolerance_ * swing_N &&
           (periods_s_.empty() || *periods_s_.rbegin() <= kMostPeriodRatio * *periods_s_.begin());
  }
  std::size_t begin() const { return begin_; }
  std::size_t end() const { return end_; }

 private:
  std::multiset<double>& forces_of(std::size_t i) { return points_[i].is_maximum ? maxima_N_ : minima_N_; }

  const std::vector<Point>& points_;
  double tolerance_;
  std::size_t begin_ = 0, end_ = 0;
  std::multiset<double> maxima_N_, minima_N_, periods_s_;
};

Turns between(const Turns& t, double from_s, double to_s) {
  Turns out;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (t.t_s[i] < from_s || t.t_s[i] > to_s) continue;
    out.t_s.push_back(t.t_s[i]);
    out.setpoint_N.push_back(t.setpoint_N[i]);
    out.ati_N.push_back(t.ati_N[i]);
    out.sensor_V.push_back(t.sensor_V[i]);
  }
  return out;
}

}  // namespace

SteadyStretch longest_steady_stretch(const Extrema& all, double tolerance) {
  const std::vector<Point> points = in_order_of_time(all);
  SteadyStretch out;
  out.is_whole = false;
  std::size_t begin = 0, end = 0;
  Run run(points, tolerance);
  while (run.end() < points.size()) {
    run.push_back();
    while (!run.is_steady()) run.pop_front();
    if (run.end() - run.begin() > end - begin) begin = run.begin(), end = run.end();
  }
  if (end - begin < 2) return out;
  out.begin_s = points[begin].t_s;
  out.end_s = points[end - 1].t_s;
  out.is_whole = end - begin == points.size();
  // a turn that borders on something else was averaged over rows of it
  const double first_s = points[begin > 0 ? begin + 1 : begin].t_s, last_s = points[end < points.size() ? end - 2 : end - 1].t_s;
  out.extrema.maxima = between(all.maxima, first_s, last_s);
  out.extrema.minima = between(all.minima, first_s, last_s);
  return out;
}

}  // namespace forcegate::characterize
