#include <algorithm>
#include <array>
#include <fstream>
#include <optional>

#include "hil/base/text.h"
#include "hil/trace/hdf5_handle.h"
#include "hil/trace/hdf5_io.h"
#include "hil/trace/missing_count.h"

namespace forcegate {
namespace {

constexpr std::size_t kLongestText = 1u << 26;

// Reading fills as many items as the file says: only one has room.
bool holds_one_item(hid_t space_of_it) {
  Hdf5Handle space(space_of_it, H5Sclose);
  return space.good() && H5Sget_simple_extent_npoints(space) == 1;
}

std::optional<std::string> text_of(hid_t attribute) {
  if (!holds_one_item(H5Aget_space(attribute))) return std::nullopt;
  Hdf5Handle type(H5Aget_type(attribute), H5Tclose);
  if (!type.good() || H5Tget_class(type) != H5T_STRING) return std::nullopt;
  if (H5Tis_variable_str(type) > 0) {  // as h5py writes them
    char* text = nullptr;
    if (H5Aread(attribute, type, &text) < 0 || !text) return std::nullopt;
    std::string out(text);
    H5free_memory(text);
    return out;
  }
  if (H5Tget_size(type) > kLongestText) return std::nullopt;
  std::string out(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, out.data()) < 0) return std::nullopt;
  out.resize(std::min(out.size(), out.find('\0')));
  return out;
}

std::optional<std::string> text_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return std::nullopt;
  Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  return attribute.good() ? text_of(attribute) : std::nullopt;
}

std::optional<double> number_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return std::nullopt;
  Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  double value = 0.0;
  if (!attribute.good() || !holds_one_item(H5Aget_space(attribute)) || H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) < 0) return std::nullopt;
  return value;
}

std::vector<std::string> links_of(hid_t group) {
  std::vector<std::string> names;
  H5G_info_t info;
  if (H5Gget_info(group, &info) < 0) return names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    char name[512];
    if (H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name, H5P_DEFAULT) > 0)
      names.emplace_back(name);
  }
  return names;
}

template <class T>
bool read_column(hid_t data, hid_t type, std::vector<T>& out) {
  Hdf5Handle space(H5Dget_space(data), H5Sclose);
  if (!space.good() || H5Sget_simple_extent_ndims(space) != 1) return false;
  const hssize_t n = H5Sget_simple_extent_npoints(space);
  if (n < 0 || n > hssize_t{1} << 33) return false;
  out.resize(static_cast<std::size_t>(n));
  return n == 0 || H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()) >= 0;
}

// Files from before the attribute held -1 for a count that is missing.
std::int32_t missing_count(hid_t data) { return static_cast<std::int32_t>(number_attribute(data, "missing").value_or(-1.0)); }

herr_t collect_text(hid_t object, const char* name, const H5A_info_t*, void* into) {
  if (auto text = text_attribute(object, name))
    (*static_cast<std::map<std::string, std::string>*>(into))[name] = std::move(*text);
  return 0;
}

struct Ordered {
  int order;
  Channel channel;
};

class Reader {
 public:
  Reader(hid_t file, const std::filesystem::path& path) : file_(file), path_(path.string()) {}

  Result<Trace> read() {
    const auto format = number_attribute(file_, "format");
    if (!format || text_attribute(file_, "kind") != "forcegate trace")
      return error("this HDF5 file is not a trace of Forcegate", "export the columns as CSV and read that");
    if (*format > kTraceFormat)
      return error("the file has trace format " + shortest(*format) + ", this program knows up to " +
                       std::to_string(kTraceFormat),
                   "use a newer Forcegate");
    trace_.name = text_attribute(file_, "name").value_or("");
    FORCEGATE_CHECK_OK(read_times());
    FORCEGATE_CHECK_OK(read_channels("channels", false));
    FORCEGATE_CHECK_OK(read_channels("raw", true));
    std::stable_sort(found_.begin(), found_.end(),
                     [](const Ordered& a, const Ordered& b) { return a.order < b.order; });
    for (Ordered& o : found_) trace_.channels.push_back(std::move(o.channel));
    read_meta();
    return std::move(trace_);
  }

 private:
  Unexpected error(std::string text,
                   std::string hint = "the file is damaged or was written by another program") const {
    return fail(ErrorCode::parse, std::move(text), path_, std::move(hint));
  }

  Hdf5Handle open_group(const char* name) const {
    if (H5Lexists(file_, name, H5P_DEFAULT) <= 0) return {};
    return {H5Gopen2(file_, name, H5P_DEFAULT), H5Gclose};
  }

  Result<void> read_times() {
    const Hdf5Handle group = open_group("time");
    if (!group.good()) return error("the file has no group /time");
    for (int k = 0; H5Lexists(group, std::to_string(k).c_str(), H5P_DEFAULT) > 0; ++k) {
      const std::string name = std::to_string(k);
      Hdf5Handle data(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
      TimeBase base;
      if (!data.good() || !read_column(data, H5T_NATIVE_DOUBLE, base.t_s))
        return error("/time/" + name + " cannot be read");
      base.device = text_attribute(data, "device").value_or("");
      base.nominal_rate_Hz = number_attribute(data, "nominal_rate_Hz").value_or(0.0);
      base.invented = number_attribute(data, "invented").value_or(0.0) != 0.0;
      for (std::size_t i = 1; i < base.t_s.size(); ++i)
        if (!(base.t_s[i] > base.t_s[i - 1]))
          return error("/time/" + name + " does not ascend at sample " + std::to_string(i));
      const std::string gap_name = name + "_gaps";
      if (H5Lexists(group, gap_name.c_str(), H5P_DEFAULT) > 0) {
        Hdf5Handle table(H5Dopen2(group, gap_name.c_str(), H5P_DEFAULT), H5Dclose);
        std::vector<double> rows;
        if (!table.good() || !read_column(table, H5T_NATIVE_DOUBLE, rows))
          return error("/time/" + gap_name + " cannot be read");
        for (std::size_t i = 0; i + 2 < rows.size(); i += 3)
          base.gaps.push_back({static_cast<std::size_t>(std::max(0.0, rows[i])), rows[i + 1], rows[i + 2]});
      }
      trace_.time_bases.push_back(std::move(base));
    }
    if (trace_.time_bases.empty()) return error("the file has no time base");
    return {};
  }

  Result<void> read_channels(const char* group_name, bool counts) {
    const Hdf5Handle group = open_group(group_name);
    if (!group.good()) return error(std::string("the file has no group /") + group_name);
    for (const std::string& link : links_of(group)) {
      const std::string place = "/" + std::string(group_name) + "/" + link;
      Hdf5Handle data(H5Dopen2(group, link.c_str(), H5P_DEFAULT), H5Dclose);
      if (!data.good()) return error(place + " cannot be opened");
      Channel channel;
      channel.name = text_attribute(data, "name").value_or(link);
      channel.unit = text_attribute(data, "unit").value_or("");
      channel.quantity = text_attribute(data, "quantity").value_or("");
      const double base = number_attribute(data, "time_base").value_or(0.0);
      if (!(base >= 0.0 && base < static_cast<double>(trace_.time_bases.size())))
        return error(place + " names a time base that is not there");
      channel.time_base = static_cast<std::size_t>(base);
      const bool read = counts ? read_column(data, H5T_NATIVE_INT32, channel.raw)
                               : read_column(data, H5T_NATIVE_DOUBLE, channel.value);
      const std::size_t n = counts ? channel.raw.size() : channel.value.size();
      if (!read) return error(place + " cannot be read");
      if (n != trace_.time_bases[channel.time_base].t_s.size())
        return error(place + " has " + std::to_string(n) + " samples, its time base " +
                     std::to_string(trace_.time_bases[channel.time_base].t_s.size()));
      if (counts) {
        std::ranges::replace(channel.raw, missing_count(data), kMissingCount);
        const auto physical = std::find_if(found_.begin(), found_.end(), [&](const Ordered& o) {
          return o.channel.name == channel.name && o.channel.time_base == channel.time_base &&
                 o.channel.raw.empty();
        });
        if (physical != found_.end()) {
          physical->channel.raw = std::move(channel.raw);
          continue;
        }
        channel.value.reserve(n);
        for (const std::int32_t code : channel.raw) channel.value.push_back(value_of_count(code));
      }
      found_.push_back({static_cast<int>(number_attribute(data, "order").value_or(1e6)), std::move(channel)});
    }
    return {};
  }

  void read_meta() {
    const Hdf5Handle meta = open_group("meta");
    if (!meta.good()) return;
    H5Aiterate2(meta, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect_text, &trace_.provenance);
    for (const std::string& link : links_of(meta)) {
      Hdf5Handle data(H5Dopen2(meta, link.c_str(), H5P_DEFAULT), H5Dclose);
      if (!data.good() || !holds_one_item(H5Dget_space(data))) continue;
      Hdf5Handle type(H5Dget_type(data), H5Tclose);
      if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0) continue;
      if (H5Tget_size(type) > kLongestText) continue;
      std::string text(H5Tget_size(type), '\0');
      if (H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) >= 0)
        trace_.provenance[link] = std::move(text);
    }
  }

  hid_t file_;
  std::string path_;
  Trace trace_;
  std::vector<Ordered> found_;
};

// By its first bytes, as it is named.
std::string help_for_no_hdf5(const std::filesystem::path& path) {
  std::array<char, 512> head{};
  std::ifstream in(path, std::ios::binary);
  in.read(head.data(), head.size());
  const std::string_view begin(head.data(), static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
  if (begin.starts_with("MATLAB 5.0")) return "it is a MATLAB file: give it the ending .mat";
  const bool is_text = !begin.empty() && std::ranges::none_of(begin, [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\r' && c != '\t'; });
  return is_text ? "it is text: give it the ending .csv" : "was it cut short while being copied?";
}

}  // namespace

Result<TraceFile> read_hdf5(const std::filesystem::path& path) {
  const Hdf5Lock lock;
  std::error_code failed;
  if (!std::filesystem::exists(path, failed))
    return fail(ErrorCode::io, "there is no such file", path.string(), "check the name");
  if (H5Fis_hdf5(path.c_str()) <= 0)
    return fail(ErrorCode::parse, "this is not an HDF5 file", path.string(), help_for_no_hdf5(path));
  Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file.good())
    return fail(ErrorCode::parse, "the HDF5 file cannot be opened", path.string(),
                "was it cut short while being copied?");
  Reader reader(file, path);
  FORCEGATE_TRY(Trace trace, reader.read());
  return TraceFile{std::move(trace), {}, {}, {}, 0, {}};
}

}  // namespace forcegate
