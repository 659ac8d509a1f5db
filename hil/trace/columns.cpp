#include "hil/trace/columns.h"

#include <algorithm>
#include <array>

#include "hil/base/text.h"
#include "hil/trace/channels.h"

namespace forcegate {
namespace {

std::string identifier(std::string_view text) {
  std::string out(trim(text));
  std::replace(out.begin(), out.end(), ' ', '_');
  return out;
}

const KnownChannel* synonym(std::string_view name) {
  const std::string word = ascii_lower(name);
  for (const KnownChannel& channel : kKnownChannels)
    for (const std::string_view w : channel.words)
      if (!w.empty() && word == w) return &channel;
  return nullptr;
}

}  // namespace

std::string known_name(std::string_view name) {
  const KnownChannel* known = synonym(name);
  return std::string(known != nullptr ? known->name : name);
}

namespace {

bool names_a_clock(std::string_view name) {
  static constexpr std::array kClocks = {"t",     "time",  "timestamp", "time_stamp", "elapsed", "elapsed_time",
                                         "clock", "t_rel", "sec",       "seconds",    "zeit",    "ts",
                                         "uhrzeit", "x_value"};  // the last as LabVIEW writes it
  if (name == "T" || name == "Ts") return false;  // a temperature, the period of sampling
  const std::string word = ascii_lower(name);
  return std::any_of(kClocks.begin(), kClocks.end(), [&](const char* c) { return word == c; });
}

/// "TIME_S", "TIME [MS]": beside the name of a clock capitals are no siemens.
std::optional<NamedColumn> clock_in_capitals(std::string_view header) {
  header = trim(header);
  const bool bracket = !header.empty() && (header.back() == ')' || header.back() == ']');
  const std::size_t at = bracket ? header.rfind(header.back() == ')' ? '(' : '[') : header.rfind('_');
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view tail = header.substr(at + 1, header.size() - at - (bracket ? 2 : 1));
  const auto unit = find_unit(ascii_lower(trim(tail)));
  const std::string name = identifier(header.substr(0, at));
  if (!unit || unit->quantity != "time" || !names_a_clock(name)) return std::nullopt;
  return NamedColumn{name, *unit};
}

/// "F_ref_g", "Force (g)", "weight [g]": what is named as a force or a mass is no acceleration.
std::optional<NamedColumn> grams_of_force(std::string_view header) {
  const bool bracket = header.ends_with("(g)") || header.ends_with("[g]");
  if (!bracket && !header.ends_with("_g")) return std::nullopt;
  const std::string name = identifier(header.substr(0, header.size() - (bracket ? 3 : 2))), word = ascii_lower(name);
  static constexpr std::array kForces = {"force", "kraft", "load_cell", "loadcell", "weight", "gewicht", "mass"};  // a "load" may be one of turning
  const bool force = std::ranges::any_of(kForces, [&](const char* f) { return word.find(f) != std::string::npos; });
  // "F_g" may be gravity's
  if (!force && !word.starts_with("f_") && word != "fref" && !(bracket && word == "f")) return std::nullopt;
  return NamedColumn{name, *find_unit("gf")};
}

/// Unit in brackets or after a slash: "Force (mN)".
std::optional<NamedColumn> split_bracket(std::string_view header) {
  header = trim(header);
  std::size_t open = std::string_view::npos;
  std::string_view symbol;
  if (!header.empty() && (header.back() == ')' || header.back() == ']')) {
    const char close = header.back(), begin = close == ')' ? '(' : '[';
    std::size_t depth = 0;
    for (open = header.size(); open-- > 0;) {  // "Force (Newton(s))"
      depth += header[open] == close;
      if (header[open] == begin && --depth == 0) break;
    }
    if (open != std::string_view::npos) symbol = header.substr(open + 1, header.size() - open - 2);
  } else if ((open = header.rfind('/')) != std::string_view::npos ||
             (open = header.rfind(',')) != std::string_view::npos) {
    symbol = header.substr(open + 1);
  }
  if (open == std::string_view::npos || open == 0) return std::nullopt;
  const auto unit = find_unit(trim(symbol));
  if (!unit) return std::nullopt;
  return NamedColumn{identifier(header.substr(0, open)), *unit};
}

/// "Kraft in N", as a person writes it.
std::optional<NamedColumn> split_word_in(std::string_view header) {
  header = trim(header);
  const std::size_t at = header.rfind(" in ");
  if (at == std::string_view::npos || at == 0) return std::nullopt;
  const auto unit = find_unit(trim(header.substr(at + 4)));
  return unit ? std::optional(NamedColumn{identifier(header.substr(0, at)), *unit}) : std::nullopt;
}

/// "Temperature °C": only where the name before the blank has that quantity, for a last word may be part of a name.
std::optional<NamedColumn> split_last_word(std::string_view header) {
  header = trim(header);
  const std::size_t at = header.rfind(' ');
  if (at == std::string_view::npos) return std::nullopt;
  const auto unit = find_unit(header.substr(at + 1));
  const std::string name = identifier(header.substr(0, at));
  if (!unit) return std::nullopt;
  const KnownChannel* known = synonym(name);
  const bool goes = unit->quantity == "time" ? names_a_clock(name) : known != nullptr && known->quantity == unit->quantity;
  return goes ? std::optional(NamedColumn{name, *unit}) : std::nullopt;
}

}  // namespace

ColumnMeaning meaning_of(std::string_view header) {
  ColumnMeaning out;
  auto named = split_bracket(header);
  if (!named) named = split_unit_suffix(trim(header));
  if (!named) named = split_word_in(header);
  if (!named) named = split_last_word(header);
  if (!named) named = grams_of_force(trim(header));
  if (!named || named->unit.quantity != "time")
    if (auto clock = clock_in_capitals(header)) named = std::move(clock);
  if (named) {
    out.name = named->name;
    out.unit = named->unit;
    const std::size_t at = out.name.rfind('_');
    const std::string_view before =
        at == std::string::npos || at == 0 ? std::string_view{} : std::string_view(out.name).substr(at + 1);
    if (out.unit.quantity == "time" && (before == "cm" || before == "dm" || find_unit(before))) {
      const std::string rate = std::string(before) + "/" + out.unit.symbol;
      out.unit = Unit{rate, rate, "rate", 1.0, 0.0};
      out.name.resize(at);
      return out;
    }
    const KnownChannel* known = synonym(out.name);
    if (out.unit.symbol == "F" && known && known->quantity == "temperature")
      out.unit = *find_unit("degF");
    out.is_clock = out.unit.quantity == "time" && names_a_clock(out.name);
    return out;
  }
  out.name = identifier(header);
  if (const std::string word = ascii_lower(out.name);
      word == "millis" || word == "micros") {  // as an Arduino prints them
    out.is_clock = true;
    out.unit = *find_unit(word == "millis" ? "ms" : "us");
    return out;
  } else if (word == "adc" || word == "counts") {
    out.unit = *find_unit("counts");
    return out;
  }
  if (names_a_clock(out.name)) {
    out.is_clock = true;
    out.unit = *find_unit("s");
    out.note = "column \"" + out.name + "\" has no unit; seconds were assumed";
  } else if (out.name == "T") {
    out.name = "temp";
    out.unit = *find_unit("C");
    out.note = "column \"T\" was taken for a temperature in degree Celsius";
  } else if (const KnownChannel* known = synonym(out.name)) {
    out.unit = *find_unit(known->unit);
    out.note = "column \"" + out.name + "\" has no unit; " + out.unit.symbol + " was assumed";
  }
  return out;
}

std::string meant_but_for_capitals(std::string_view header) {
  const std::string lower = ascii_lower(trim(header));
  std::vector<std::string> names{"t_s", "t_ms", "t_us"};
  for (const KnownChannel& channel : kKnownChannels) names.push_back(header_of(channel.name, channel.unit));
  const auto meant = std::ranges::find_if(names, [&](const std::string& name) { return ascii_lower(name) == lower; });
  return meant == names.end() || *meant == trim(header) ? std::string() : *meant;
}

std::string unknown_unit(std::string_view header) {
  const ColumnMeaning meaning = meaning_of(header);
  if (!meaning.unit.symbol.empty() && meaning.note.empty()) return {};
  header = trim(header);
  if (!header.empty() && (header.back() == ')' || header.back() == ']')) {
    const std::size_t open = header.rfind(header.back() == ')' ? '(' : '[');
    return open == std::string_view::npos || open == 0 ? std::string() : std::string(trim(header.substr(open + 1, header.size() - open - 2)));
  }
  const std::size_t at = header.rfind('_');
  if (at == 0) return {};
  const bool bare = at == std::string_view::npos;  // a column that is called "g"; one that is called "t" is a clock
  const std::string_view tail = bare ? header : header.substr(at + 1);
  static constexpr std::array kOthers = {"g", "mg", "oz", "t", "kp", "psi", "atm", "torr", "inch", "dBV"};
  const bool other = std::ranges::any_of(kOthers, [&](const char* unit) { return tail == unit; });
  const bool scaled = tail.size() > 1 && std::string_view("fpnumcdhkMGT").find(tail.front()) != std::string_view::npos && find_unit(tail.substr(1)).has_value();
  return (other && !(bare && meaning.is_clock)) || (scaled && !bare) ? std::string(tail) : std::string();
}

std::vector<std::string> use_canonical_names(Trace& trace, const std::vector<std::string>& headers) {
  std::vector<std::string> notes;
  const auto rename = [&](Channel& channel, std::string_view name, const std::string& why) {
    const auto at = static_cast<std::size_t>(&channel - trace.channels.data());
    notes.push_back("column \"" + (at < headers.size() ? headers[at] : header_of(channel.name, channel.unit)) + "\" was taken for " + std::string(name) + why);
    channel.name = name;
  };
  for (Channel& channel : trace.channels) {
    const KnownChannel* known = synonym(channel.name);
    if (!known || channel.quantity != known->quantity || channel.name == known->name) continue;
    if (trace.find(known->name)) continue;
    if (channel.name.size() == 1 || known->name == "supply")
      channel.name = known->name;  // "F", "U": nothing to tell
    else
      rename(channel, known->name, "");
  }
  for (const KnownChannel& wanted : kKnownChannels) {
    if (!wanted.stands_alone || trace.find(wanted.name)) continue;
    Channel* only = nullptr;
    std::size_t n = 0;
    for (Channel& channel : trace.channels) {
      const KnownChannel* known = synonym(channel.name);
      if (channel.quantity != wanted.quantity || (known && channel.name == known->name)) continue;
      ++n;
      only = &channel;
    }
    if (n == 1) rename(*only, wanted.name, ", the only " + std::string(wanted.quantity));
  }
  // a sensor that is read as counts, resistance or conductance: every law here is fitted in the output's own scale. Of several voltages one is the
  // output, and the current of a motor is not
  const bool has_voltage = std::ranges::any_of(trace.channels, [](const Channel& c) { return c.quantity == "voltage" && known_channel(c.name) == nullptr; });
  if (!trace.find("U") && !has_voltage)
    for (const char* quantity : {"code", "conductance", "resistance", "current"}) {
      const auto is_output = [&](const Channel& channel) { return channel.quantity == quantity; };
      if (std::count_if(trace.channels.begin(), trace.channels.end(), is_output) != 1) continue;
      rename(*std::find_if(trace.channels.begin(), trace.channels.end(), is_output), "U",
             "; errors are given in its own unit");
      break;
    }
  return notes;
}

std::vector<std::string> unused_columns(const Trace& trace, const std::map<std::string, std::string>& headers) {
  std::vector<std::string> out;
  for (const Channel& channel : trace.channels)
    if (known_channel(channel.name) == nullptr && channel.name != "unused")
      out.push_back(headers.contains(channel.name) ? headers.at(channel.name) : header_of(channel.name, channel.unit));
  return out;
}

std::string header_of(std::string_view name, std::string_view unit) {
  std::string out(name);
  if (unit.empty() || unit == "1") return out;
  out += '_';
  out += unit;
  std::replace(out.begin(), out.end(), '/', '_');
  return out;
}

void make_names_unique(Trace& trace) {
  for (std::size_t i = 0; i < trace.channels.size(); ++i) {
    Channel& c = trace.channels[i];
    const auto taken = [&](const std::string& name) {
      return std::any_of(trace.channels.begin(), trace.channels.begin() + static_cast<std::ptrdiff_t>(i),
                         [&](const Channel& other) { return other.name == name; });
    };
    if (!taken(c.name)) continue;
    const std::string base = header_of(c.name, c.unit);
    c.name = base;
    for (int k = 2; taken(c.name); ++k) c.name = base + "_" + std::to_string(k);
  }
}

}  // namespace forcegate
