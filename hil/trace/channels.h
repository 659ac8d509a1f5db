#pragma once
// The channels that Forcegate knows (docs/campaign.md): the one list of their names. What asks whether a column is read, what another
// program calls it, or whether it may be the cause of a drift, asks here.

#include <array>
#include <string_view>

namespace forcegate {

struct KnownChannel {
  std::string_view name;      ///< "F_ref"
  std::string_view quantity;  ///< "force"
  std::string_view unit;      ///< of a header that tells none; "N"
  bool stands_alone;          ///< the only column of the quantity in a file is this one
  bool is_cause;              ///< what drifts with it may drift because of it
  std::array<std::string_view, 11> words;  ///< what others call it, lower case
};

inline constexpr std::array kKnownChannels = {
    KnownChannel{"F_ref", "force", "N", true, false, {"f_ref", "fref", "f", "force", "ati", "f_ati", "force_ref", "reference", "load_cell", "fz", "kraft"}},
    KnownChannel{"F_cmd", "force", "N", false, false,
                 {"f_cmd", "f_set", "setpoint", "set_point", "command", "target", "f_target", "f_sp", "soll", "sollwert", "sollkraft"}},
    KnownChannel{"F_dut", "force", "N", false, false, {"f_dut", "dut", "f_est", "estimate", "firmware", "f_fw"}},
    KnownChannel{"U", "voltage", "V", true, false, {"u", "v", "voltage", "vout", "v_out", "u_out", "sensor", "u_sensor", "signal", "spannung"}},
    KnownChannel{"theta", "angle", "rad", true, false, {"theta", "angle", "phi", "wheel", "winkel"}},
    KnownChannel{"temp", "temperature", "C", true, true, {"temp", "temperature", "t_amb", "temp_amb", "temperatur"}},
    KnownChannel{"humidity", "ratio", "pct", false, true,
                 {"humidity", "rh", "relative_humidity", "rel_humidity", "rel_hum", "hum", "luftfeuchte", "feuchte"}},
    KnownChannel{"C", "capacitance", "F", true, false, {"c", "capacitance", "cap", "kapazitaet", "kapazit\xC3\xA4t"}},
    KnownChannel{"drive", "voltage", "V", false, true, {"drive", "v_drive", "u_drive"}},
    // the drive where its level was set from record to record, else nothing but a note
    KnownChannel{"supply", "voltage", "V", false, false, {"supply", "vcc", "v_supply", "versorgung"}},
};

/// By its own name; nullptr: a column that nothing reads.
constexpr const KnownChannel* known_channel(std::string_view name) {
  for (const KnownChannel& channel : kKnownChannels)
    if (channel.name == name) return &channel;
  return nullptr;
}

}  // namespace forcegate
