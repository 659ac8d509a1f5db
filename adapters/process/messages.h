#pragma once
// What the harness and an adapter in a program of its own say to each other: one JSON object per line, docs/adapters.md.
//   harness:  {"id":7,"do":"poll","now_s":1.25}
//   adapter:  {"id":7,"ok":true,"clock_s":88.1,"rows":[[88.095,1.5021,0]]}
//             {"id":7,"ok":false,"error":"no answer","hint":"check the cable"}

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "hil/base/config_node.h"
#include "hil/base/result.h"

namespace forcegate::process {

inline constexpr std::size_t kLineMax = 1 << 20;  ///< a longer line is no answer
inline constexpr std::size_t kRowWidth = 4;

using Value = std::variant<double, std::int64_t, bool, std::string, const ConfigNode*>;
using Fields = std::vector<std::pair<std::string, Value>>;

/// Without the line feed. A table of the bench file becomes an object.
std::string encode_request(std::uint64_t id, std::string_view verb, double now_s, const Fields& fields);

struct Reply {
  std::uint64_t id = 0;
  bool good = false;
  std::string error, hint;                  ///< printable
  std::map<std::string, std::string> text;  ///< printable
  std::map<std::string, double> number;     ///< truth values are 0 and 1; finite
  std::vector<std::vector<double>> rows;    ///< null = NaN; of 1 to kRowWidth numbers
};

/// Strict: anything that is not such an object is an error, never half a reply.
Result<Reply> decode_reply(std::string_view line);

}  // namespace forcegate::process
