// Cost of one sample of the emulated rig in CPU time: physics alone and with controller and profile.
//   speed_rig [minutes of record, default 20]

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>

#include "hil/interface/controller.h"
#include "hil/interface/rig.h"
#include "hil/interface/stimulus.h"

namespace {

using namespace forcegate;

double cpu_s() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Cost {
  double rig_ns = 0, all_ns = 0;
};

Cost measure(const char* sensor, const char* controller_name, double minutes) {
  StimulusSpec spec;
  spec.name = "sine";
  spec.numbers = {{"f_Hz", 0.5}, {"A_N", 1.05}, {"m_N", 2.15}, {"duration_s", 60.0 * minutes}};
  const auto profile = make_stimulus(spec);
  const auto rig = make_rig("emulated", {{"sensor", sensor}});
  const ControllerKind* kind = Registry<ControllerKind>::instance().find(controller_name);
  if (!profile || !rig || kind == nullptr) std::exit(1);
  RigRecordRequest request;
  request.duration_s = (*profile)->duration_s();
  request.force_low_N = 1.1;
  request.force_high_N = 3.2;
  if (!(*rig)->begin(request)) std::exit(1);
  const auto control = kind->make();
  control->reset((*rig)->info().geometry);
  RigBlock block;
  block.resize(10);
  double setpoint[10];
  ControllerInput in;
  double all_s = -cpu_s();
  const long periods = static_cast<long>(request.duration_s * 100.0);
  double sink = 0.0;
  for (long k = 0; k < periods; ++k) {
    in.t_s = static_cast<double>(k) * 0.01;
    (*profile)->fill(in.t_s, 0.001, 10, setpoint);
    in.setpoint_N = setpoint[0];
    in.setpoint_next_N = setpoint[9];
    in.theta_rad = (*rig)->theta_rad();
    in.estimate_N = (*rig)->force_ref_N();
    if (!(*rig)->command_velocity(control->velocity_rad_per_s(in))) std::exit(1);
    const auto n = (*rig)->run(10, block, 0);
    if (!n || *n != 10) std::exit(1);
    sink += block.adc[9];
  }
  all_s += cpu_s();

  if (!(*rig)->begin(request)) std::exit(1);
  RigBlock large;
  large.resize(1000);
  double rig_s = -cpu_s();
  for (long k = 0; k < periods; k += 100) {
    (void)(*rig)->command_velocity(k % 200 ? 0.5 : -0.5);
    const auto n = (*rig)->run(1000, large, 0);
    if (!n) std::exit(1);
    sink += large.adc[9];
  }
  rig_s += cpu_s();
  if (sink < 0.0) std::puts("");
  const double samples = static_cast<double>(periods) * 10.0;
  return {1e9 * rig_s / samples, 1e9 * all_s / samples};
}

}  // namespace

int main(int argc, char** argv) {
  const double minutes = argc > 1 ? std::atof(argv[1]) : 20.0;
  std::printf("%-12s %-15s %14s %22s %16s\n", "sensor", "controller", "rig ns/sample", "with controller ns",
              "x real time");
  for (const char* sensor : {"flexiforce", "fsr"})
    for (const char* controller : {"open_loop", "force_integral"}) {
      const Cost c = measure(sensor, controller, minutes);
      std::printf("%-12s %-15s %14.1f %22.1f %16.0f\n", sensor, controller, c.rig_ns, c.all_ns,
                  1e6 / c.all_ns);
    }
}
