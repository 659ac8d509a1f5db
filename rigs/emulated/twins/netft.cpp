#include "rigs/emulated/twins/netft.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "hil/base/text.h"

namespace forcegate::emulated {
namespace {

void put(Bytes& out, std::uint32_t word) {
  for (const int shift : {24, 16, 8, 0}) out.push_back(static_cast<std::uint8_t>(word >> shift));
}

}  // namespace

Bytes NetFt::record(std::uint32_t rdt, std::uint32_t ft, std::uint32_t status, std::int32_t counts_Fz) {
  Bytes out;
  put(out, rdt);
  put(out, ft);
  put(out, status);
  for (const std::int32_t counts : {3, -2, counts_Fz, 1, 0, -1}) put(out, static_cast<std::uint32_t>(counts));
  return out;
}

void NetFt::power_cycle() {
  streaming_ = false;
  bias_N_ = 0.0;
  ft_ = 0;
}

void NetFt::serve(WireEnd& end, double) {
  const Bytes q = std::move(end.rest);
  end.rest.clear();
  if (q.size() != 8 || q[0] != 0x12 || q[1] != 0x34) return;  // a datagram that is no request is ignored
  const int command = q[2] << 8 | q[3];
  if (command == 0) streaming_ = false;
  if (command == 2 || command == 3) {
    streaming_ = true;
    rdt_ = 0;
    left_ = static_cast<std::uint32_t>(q[4]) << 24 | static_cast<std::uint32_t>(q[5]) << 16 |
            static_cast<std::uint32_t>(q[6]) << 8 | q[7];
    next_s_ = 0.0;
  }
  if (command == 0x42) bias_N_ = force_N_;
}

void NetFt::row(double t_s, double force_N, bool saturated) {
  force_N_ = force_N;
  const bool frozen = wire_.faults().active("reference", WireFault::frozen, t_s);
  if (frozen && !was_frozen_) frozen_N_ = force_N;
  was_frozen_ = frozen;
  if (!frozen) ++ft_;
  if (!streaming_) return;
  if (next_s_ <= 0.0 || next_s_ < t_s - 1.0) next_s_ = t_s;
  if (t_s + 1e-9 < next_s_) return;
  next_s_ += 1.0 / o_.rate_Hz;
  saturated = saturated || wire_.faults().active("reference", WireFault::saturation, t_s);
  const double counts = ((frozen ? frozen_N_ : force_N) - bias_N_) * o_.counts_per_N;
  wire_.send(
      nullptr,
      record(++rdt_, ft_, saturated ? 0x80020000U : 0U, static_cast<std::int32_t>(std::lround(counts))), t_s);
  if (left_ > 0 && --left_ == 0) streaming_ = false;
}

void NetFt::serve_page(Wire& wire, WireEnd& end, double t_s) const {
  const std::string request(end.rest.begin(), end.rest.end());
  if (request.find("\r\n\r\n") == std::string::npos) return;
  end.rest.clear();
  std::string body, status = "404 Not Found";
  if (request.starts_with("GET /netftapi2.xml ")) {
    status = "200 OK";
    body = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<netft><prodname>Net F/T</prodname><setserial>" +
           o_.serial + "</setserial><comrdtrate>" + shortest(o_.rate_Hz) + "</comrdtrate><cfgcpf>" +
           shortest(o_.counts_per_N) +
           "</cfgcpf><cfgcpt>1000000</cfgcpt><scfgfu>N</scfgfu><scfgtu>Nm</scfgtu></netft>\n";
  }
  const std::string page = "HTTP/1.0 " + status +
                           "\r\nContent-Type: text/xml\r\nContent-Length: " + std::to_string(body.size()) +
                           "\r\nConnection: close\r\n\r\n" + body;
  wire.send(&end, Bytes(page.begin(), page.end()), t_s);
  end.fd.reset();
}

}  // namespace forcegate::emulated
