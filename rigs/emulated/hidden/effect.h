#pragma once
// A hidden effect: one physical departure of sensor, rig, reference or instrument from the ideal bench, with
// a strength. At strength 0 every hook is the identity. One file each in effects/, found through the
// registry.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hil/base/registry.h"
#include "hil/base/rng.h"
#include "rigs/emulated/hidden/waves.h"

namespace forcegate::hidden {

class HiddenEffect {
 public:
  virtual ~HiddenEffect() = default;

  /// 0 = absent, 1 = typical size. Called before begin_campaign.
  void set_strength(double strength) { strength_ = strength; }
  double strength() const { return strength_; }

  /// One sentence that tells form and parameters, for the reveal.
  virtual std::string form() const = 0;

  /// Forget everything (also between the preview runs that set the strength).
  virtual void begin_campaign() {}
  virtual void begin_record(const RecordContext&) {}

  // Hooks in physical order. Each may change the signal it is named after from those before it.
  virtual void angle(Waves&, const RecordContext&) {}
  virtual void travel(Waves&, const RecordContext&) {}
  virtual void force(Waves&, const RecordContext&) {}
  virtual void reference(Waves&, const RecordContext&) {}
  virtual void film(Waves&, const RecordContext&) {}
  virtual void voltage(Waves&, const RecordContext&) {}      ///< sensor side of the circuit
  virtual void electronics(Waves&, const RecordContext&) {}  ///< circuit and amplifier
  /// Instant at which the voltage channel is really read when the recorder means t.
  virtual double voltage_instant_s(double t_s, const RecordContext&) { return t_s; }
  virtual void samples(Samples&, const RecordContext&) {}  ///< before rounding
  virtual void codes(std::vector<int>&, int /*adc_bits*/, const RecordContext&) {}
  virtual void logged(Samples&, const RecordContext&) {}  ///< after rounding: the file itself

 protected:
  double strength_ = 0.0;
};

/// Which channel shows the effect and so carries its strength.
enum class Measure { voltage, force };

/// What can hide the effect; its tiers are raised to stand out from it.
enum class Rival { none, repeatability, reference_noise };

/// What the lab must have recorded of an effect between records so that it can be told from others.
enum class Cause { loading, temperature, humidity, drive, mounting };

struct HiddenKind {
  std::string name = {};
  std::string side = {};                    ///< "sensor", "rig", "reference", "instrument"; foreign ones too
  std::vector<std::string> also_side = {};  ///< sides that a fair judge accepts as well
  Measure measure = Measure::voltage;
  bool foreign = false;  ///< outside the catalogue: the right answer is "unknown"
  Rival rival = Rival::none;
  bool reducible = true;                            ///< a model with the effect can predict the samples
  bool needs_theta = false, needs_command = false;  ///< columns
  bool needs_drive = false, needs_remounting = false, needs_climate = false,
       needs_fast_reference = false;          ///< variations; a reference without lag of its own
  std::vector<std::string> needs_kinds = {};  ///< records without which it is not excited
  std::vector<std::string> depends_on = {};   ///< foreign: coordinates a good answer may name
  Cause cause = Cause::loading;
  double strength_max = 50.0;
  std::function<std::unique_ptr<HiddenEffect>(Rng&)> make = {};
};

using HiddenRegistration = Registration<HiddenKind>;

}  // namespace forcegate::hidden
