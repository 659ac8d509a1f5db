#pragma once
// Datagrams and one small web page: what networked instruments need.

#include <memory>
#include <string>

#include "hil/interface/transport.h"

namespace forcegate {

/// UDP to one far end; what others send is not seen. `host` is a name or an address.
Result<std::unique_ptr<Transport>> connect_udp(const std::string& host, int port);

/// Body of an HTTP/1.0 page of at most 256 kB. ErrorCode::timeout or ErrorCode::device.
Result<std::string> http_get(const std::string& host, int port, const std::string& path, double timeout_s);

}  // namespace forcegate
