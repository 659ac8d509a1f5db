#pragma once
// Expected failures are values. A function that can fail because of a file, a device, a firmware or
// a user returns Result<T>; programmer mistakes are asserts. No exception crosses a library border.

#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace forcegate {

/// What kind of thing went wrong; decides the exit code and who is asked to act.
enum class ErrorCode {
  usage,      ///< the command line is wrong                               -> exit 2
  config,     ///< a plan, bench, model or limits file is wrong            -> exit 2
  parse,      ///< a data file cannot be read as what it claims to be      -> exit 2
  io,         ///< the operating system refused (missing file, full disk)  -> exit 2
  device,     ///< an instrument of the rig misbehaved                     -> exit 4
  timeout,    ///< a device or a process did not answer in time            -> exit 4
  firmware,   ///< the device under test crashed, hung or broke protocol   -> exit 1
  safety,     ///< a limit was hit and the rig was parked                  -> exit 5
  cancelled,  ///< the user interrupted                                    -> exit 130
  internal,   ///< a defect of Forcegate itself                            -> exit 6
};

std::string_view to_string(ErrorCode code);

struct Error {
  ErrorCode code = ErrorCode::internal;
  std::string text;   ///< what is wrong, one sentence without a trailing period
  std::string where;  ///< file:line:column, device name, case id ... may be empty
  std::string hint;   ///< how to mend it, one sentence; may be empty

  /// "error: TEXT\n  where: WHERE\n  help: HINT" without empty lines.
  std::string to_text() const;
};

template <class T>
using Result = tl::expected<T, Error>;

using Unexpected = tl::unexpected<Error>;

inline Unexpected fail(ErrorCode code, std::string text, std::string where = {}, std::string hint = {}) {
  return Unexpected(Error{code, std::move(text), std::move(where), std::move(hint)});
}

}  // namespace forcegate

/// Propagates the error of a Result expression: FORCEGATE_TRY(value, read(path));
#define FORCEGATE_CONCAT_IMPL(a, b) a##b
#define FORCEGATE_CONCAT(a, b) FORCEGATE_CONCAT_IMPL(a, b)
#define FORCEGATE_TRY_IMPL(temporary, declaration, expression)           \
  auto temporary = (expression);                                         \
  if (!temporary) return ::tl::unexpected(std::move(temporary).error()); \
  declaration = std::move(*temporary)
#define FORCEGATE_TRY(declaration, expression) \
  FORCEGATE_TRY_IMPL(FORCEGATE_CONCAT(try_result_, __LINE__), declaration, expression)
#define FORCEGATE_CHECK_OK(expression)                           \
  do {                                                           \
    if (auto check_result_ = (expression); !check_result_)       \
      return ::tl::unexpected(std::move(check_result_).error()); \
  } while (false)
