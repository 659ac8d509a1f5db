#include "rigs/emulated/twins/host.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <span>

#include "hil/base/read_number.h"
#include "hil/base/text.h"
#include "rigs/emulated/twins/ati_controller.h"
#include "rigs/emulated/twins/control_socket.h"
#include "rigs/emulated/twins/control_words.h"
#include "rigs/emulated/twins/digital_ft.h"
#include "rigs/emulated/twins/netft.h"

namespace forcegate::emulated {
namespace {

constexpr double kEndless_s = 9e6;
constexpr double kByteWait_s = 5.0;
constexpr std::size_t kChunk = 10;

std::string told(const Error& e) { return "error " + std::string(to_string(e.code)) + " " + e.text; }

}  // namespace

TwinHost::TwinHost(const TwinOptions& options)
    : options_(options),
      plant_(options.plant),
      motor_wire_("motor", faults_, true),
      reference_wire_("reference", faults_, false),
      board_wire_("board", faults_, false),
      page_wire_("reference", faults_, true),
      modbus_(drive_, motor_wire_, options.slave, options.tcp),
      board_(board_wire_, options.board_reports) {
  for (const FaultEntry& f : options.faults) faults_.add(f);
  motor_wire_.on_bytes = [this](WireEnd& end) {
    modbus_.serve(end, t_s_);
    drive_the_motor("control word");
  };
  modbus_.on_request = [this] { drive_.heard(t_s_); };
  if (options.reference.adapter == "ati_netft") {
    auto box = std::make_unique<NetFt>(options.reference, reference_wire_);
    page_wire_.on_bytes = [this, page = box.get()](WireEnd& end) { page->serve_page(page_wire_, end, t_s_); };
    reference_ = std::move(box);
  } else if (options.reference.adapter == "ati_digital") {
    reference_ = std::make_unique<DigitalFt>(options.reference, reference_wire_);
  } else {
    reference_ = std::make_unique<AtiController>(options.reference, reference_wire_);
  }
  reference_wire_.on_bytes = [this](WireEnd& end) { reference_->serve(end, t_s_); };
  board_wire_.on_bytes = [this](WireEnd& end) { board_.serve(end, t_s_); };
  rows_.resize(kChunk);
  paced_at_ = std::chrono::steady_clock::now();
}

Result<std::unique_ptr<TwinHost>> TwinHost::make(const TwinOptions& options,
                                                 const std::filesystem::path& folder) {
  std::unique_ptr<TwinHost> host(new TwinHost(options));
  FORCEGATE_CHECK_OK(host->open(folder));
  return host;
}

TwinHost::~TwinHost() {
  std::error_code ignored;
  for (const std::filesystem::path& path : published_) std::filesystem::remove(path, ignored);
}

Result<void> TwinHost::open(const std::filesystem::path& folder) {
  folder_ = folder;
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  const std::filesystem::path path = folder / "control";
  FORCEGATE_TRY(const sockaddr_un address, free_control_address(path));
  published_ = {path, folder / options_.board_port};
  published_.push_back(folder / (options_.tcp ? "motor.port" : options_.motor_port));
  if (reference_->is_on_network())
    published_.insert(published_.end(), {folder / "reference.udp", folder / "reference.port"});
  else
    published_.push_back(folder / options_.reference_port);
  if (options_.tcp) {
    FORCEGATE_TRY(tcp_port_, motor_wire_.open_server(options_.tcp_port));
    std::ofstream(folder / "motor.port") << tcp_port_ << '\n';
  } else {
    FORCEGATE_CHECK_OK(motor_wire_.open_terminal(folder / options_.motor_port));
  }
  if (reference_->is_on_network()) {
    FORCEGATE_TRY(const int udp, reference_wire_.open_datagrams(options_.reference.udp_port));
    FORCEGATE_TRY(const int page, page_wire_.open_server(options_.reference.http_port));
    std::ofstream(folder / "reference.udp") << udp << '\n';
    std::ofstream(folder / "reference.port") << page << '\n';
  } else {
    FORCEGATE_CHECK_OK(reference_wire_.open_terminal(folder / options_.reference_port));
  }
  FORCEGATE_CHECK_OK(board_wire_.open_terminal(folder / options_.board_port));
  std::filesystem::remove(path, ignored);
  listener_ = Descriptor(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!listener_ || bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      listen(listener_.get(), 8) != 0)
    return fail(ErrorCode::io, "cannot open the control socket: " + system_text(errno), path.string());
  const std::string mounted = mount({"mount", "low_N=0.5", "high_N=4"});
  if (mounted != "ok") return fail(ErrorCode::config, mounted);
  return {};
}

std::vector<std::string> TwinHost::endpoints() const {
  return {options_.tcp ? fmt::format("motor      Modbus TCP   127.0.0.1:{}", tcp_port_)
                       : fmt::format("motor      Modbus RTU   {}", (folder_ / options_.motor_port).string()),
          reference_->is_on_network()
              ? fmt::format("reference  {:<12} ports in {}", reference_->name(), (folder_ / "reference.udp").string())
              : fmt::format("reference  {:<11} {}", reference_->name(), (folder_ / options_.reference_port).string()),
          fmt::format("board      link         {}", (folder_ / options_.board_port).string()),
          fmt::format("control    text lines   {}", (folder_ / "control").string())};
}

Wire* TwinHost::wire_of(const std::string& device) {
  for (Wire* w : {&motor_wire_, &reference_wire_, &board_wire_})
    if (w->device() == device) return w;
  return nullptr;
}

void TwinHost::wait_for_events(double longest_s) {
  std::vector<int> fds{listener_.get()};
  for (const Client& c : clients_) fds.push_back(c.fd.get());
  for (const Wire* w : {&motor_wire_, &reference_wire_, &board_wire_, &page_wire_}) w->poll_descriptors(fds);
  std::vector<pollfd> polled;
  for (const int fd : fds) polled.push_back({fd, POLLIN, 0});
  ::poll(polled.data(), polled.size(), static_cast<int>(std::ceil(longest_s * 1e3)));
}

void TwinHost::receive_all() {
  for (Wire* w : {&motor_wire_, &reference_wire_, &board_wire_, &page_wire_}) w->receive(t_s_);
}

void TwinHost::serve(const std::atomic<bool>& stop, bool until_alone) {
  while (!stop.load()) {
    double wait_s = 0.05;
    const bool paced =
        std::none_of(clients_.begin(), clients_.end(), [](const Client& c) { return c.master; });
    if (paced) wait_s = 0.002;
    if (const double due_s = motor_wire_.send_due(t_s_); due_s >= 0.0)
      wait_s = std::min(wait_s, due_s + 1e-4);
    wait_for_events(wait_s);
    for (Wire* w : {&motor_wire_, &reference_wire_, &board_wire_, &page_wire_}) w->apply_plug(t_s_);
    if (paced)
      pace();
    else
      paced_at_ = std::chrono::steady_clock::now();
    receive_all();
    Descriptor peer(accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (peer) {
      clients_.push_back(Client{std::move(peer), {}, false});
      had_client_ = true;
    }
    for (Client& c : clients_) obey(c);
    clients_.remove_if([](const Client& c) { return !c.fd; });
    if (until_alone && had_client_ && clients_.empty()) return;
  }
}

void TwinHost::obey(Client& client) {
  for (;;) {
    char bytes[4096];
    const ssize_t n = ::read(client.fd.get(), bytes, sizeof bytes);
    if (n < 0 && errno == EINTR) continue;
    if (n == 0 || (n < 0 && errno != EAGAIN)) {
      client.fd.reset();
      return;
    }
    if (n < 0) return;
    client.pending.append(bytes, static_cast<std::size_t>(n));
    for (std::size_t end; (end = client.pending.find('\n')) != std::string::npos;) {
      const std::string line = client.pending.substr(0, end);
      client.pending.erase(0, end + 1);
      const std::string reply = execute(client, line) + "\n";
      if (::send(client.fd.get(), reply.data(), reply.size(), MSG_NOSIGNAL) !=
          static_cast<ssize_t>(reply.size())) {
        client.fd.reset();
        return;
      }
    }
    if (client.pending.size() > 65536) client.pending.clear();
  }
}

std::string TwinHost::execute(Client& client, const std::string& line) {
  std::vector<std::string> words;
  for (const std::string& w : split(line, ' '))
    if (!w.empty()) words.push_back(w);
  if (words.empty()) return "error empty line";
  const std::string& verb = words[0];
  if (verb == "advance") {
    client.master = true;
    return advance(words);
  }
  if (verb == "mount") return mount(words);
  if (verb == "flash") {
    auto done = line.size() > 6 ? board_.flash(line.substr(6)) : fail(ErrorCode::usage, "flash needs a path");
    return done ? "ok" : told(done.error());
  }
  if (verb == "attach" && words.size() == 2) {
    Wire* wire = wire_of(words[1]);
    if (wire == nullptr) return "error no such device";
    wire->receive(t_s_);
    wire->attach();
    return "ok";
  }
  if (verb == "status") return status();
  if (verb == "image") return board_.fate().empty() ? "ok runs" : "ok " + board_.fate();
  if (verb == "fault") return fault(words);
  if (verb == "load" && words.size() == 2) {
    const auto newtons = read_number(words[1]);
    if (!newtons) return "error usage load wants a weight in newtons, not '" + words[1] + "'";
    weight_N_ = *newtons;
    return "ok";
  }
  return "error unknown command; known: mount flash attach advance status image fault load";
}

std::string TwinHost::fault(const std::vector<std::string>& words) {
  if (words.size() == 2 && words[1] == "clear") {
    faults_.clear();
    return "ok";
  }
  auto entry = FaultScript::read_words(std::span(words).subspan(1));
  if (!entry) return told(entry.error());
  faults_.add(std::move(*entry));
  return "ok";
}

std::string TwinHost::mount(const std::vector<std::string>& words) {
  RigRecordRequest q;
  q.duration_s = kEndless_s;
  for (std::size_t i = 1; i < words.size(); ++i) {
    const std::size_t equals = words[i].find('=');
    if (equals == std::string::npos) return "error usage mount wants key=value";
    const std::string key = words[i].substr(0, equals), value = words[i].substr(equals + 1);
    bool good = true;
    const auto whole = [&](std::uint64_t& out) {
      const auto v = whole_in(value);
      good = v.has_value();
      out = v.value_or(out);
    };
    const auto number = [&](double& out) {
      const auto v = read_number(value);
      good = v.has_value();
      out = v.value_or(out);
    };
    if (key == "specimen")
      q.specimen = value;
    else if (key == "seed")
      whole(q.seed);
    else if (key == "session")
      whole(q.session);
    else if (key == "record")
      whole(q.record);
    else if (key == "rest_s")
      number(q.rest_before_s);
    else if (key == "low_N")
      number(q.force_low_N);
    else if (key == "high_N")
      number(q.force_high_N);
    else if (key.starts_with("fault:"))
      number(q.faults[key.substr(6)]);
    else
      return "error usage mount knows no " + key;
    if (!good) return "error usage " + key + " of mount must be a " + (key == "seed" || key == "session" || key == "record" ? "whole number" : "number") + ", not '" + value + "'";
  }
  plant_.park();
  auto begun = plant_.begin(q);
  if (!begun) return told(begun.error());
  faults_.begin_record();
  drive_.power_cycle();
  drive_.see(plant_.theta_rad(), 0.0, false);
  reference_->restart_clock(0.0);
  index_ = 0;
  t_s_ = told_rad_per_s_ = velocity_rad_per_s_ = paced_rest_ = weight_N_ = 0.0;
  stop_s_ = still_s_ = -1.0;
  stop_cause_ = "none";
  force_N_ = plant_.force_ref_N();
  paced_at_ = std::chrono::steady_clock::now();
  return "ok";
}

std::string TwinHost::advance(const std::vector<std::string>& words) {
  if (words.size() < 2) return "error advance SAMPLES";
  const auto n = whole_in(words[1]);
  if (!n || *n > 1000000) return "error usage advance wants samples from 0 to 1000000, not '" + words[1] + "'";
  // Everything that the client has sent counts as said before time goes on.
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kByteWait_s);
  for (std::size_t i = 2; i < words.size(); ++i) {
    const std::size_t equals = words[i].find('=');
    Wire* wire = equals == std::string::npos ? nullptr : wire_of(words[i].substr(0, equals));
    if (wire == nullptr) return "error advance knows no such device";
    const auto due = whole_in(std::string_view(words[i]).substr(equals + 1));
    if (!due) return "error usage advance wants DEVICE=BYTES, not '" + words[i] + "'";
    while (!wire->unplugged() && wire->terminal() != nullptr &&
           wire->terminal()->received < *due && std::chrono::steady_clock::now() < end) {
      pollfd p{wire->terminal()->fd.get(), POLLIN, 0};
      ::poll(&p, 1, 20);
      wire->receive(t_s_);
    }
  }
  step(static_cast<std::size_t>(*n));
  advanced_s_ = board_.streaming() ? board_.sent_samples() / options_.plant.rate_Hz : -1.0;
  for (Wire* w : {&reference_wire_, &board_wire_}) w->apply_plug(t_s_);
  std::string reply = fmt::format("ok {:.9g}", t_s_);
  for (Wire* w : {&reference_wire_, &board_wire_})
    reply += w->unplugged() || w->terminal() == nullptr
                 ? fmt::format(" {}=-1", w->device())
                 : fmt::format(" {}={}", w->device(), w->terminal()->sent);
  return reply;
}

void TwinHost::pace() {
  const auto now = std::chrono::steady_clock::now();
  paced_rest_ += std::chrono::duration<double>(now - paced_at_).count() * options_.plant.rate_Hz;
  paced_at_ = now;
  const double whole =
      std::min(std::floor(paced_rest_), options_.plant.rate_Hz);  // a halted process skips time
  if (whole < 1.0) return;
  paced_rest_ -= std::floor(paced_rest_);
  step(static_cast<std::size_t>(whole));
}

void TwinHost::drive_the_motor(const char* cause) {
  const double wanted = drive_.velocity_rad_per_s();
  if (wanted == told_rad_per_s_) return;
  if (wanted == 0.0) {
    stop_s_ = t_s_;
    still_s_ = -1.0;
    stop_cause_ = cause;
  }
  told_rad_per_s_ = wanted;
  (void)plant_.command_velocity(wanted);
}

void TwinHost::step(std::size_t samples) {
  const double rate_Hz = options_.plant.rate_Hz;
  while (samples > 0) {
    if (faults_.hit("motor", WireFault::reset, t_s_)) drive_.power_cycle();
    if (faults_.hit("reference", WireFault::reset, t_s_)) reference_->power_cycle();
    if (faults_.hit("board", WireFault::reset, t_s_)) board_.power_cycle();
    drive_.freeze(faults_.active("motor", WireFault::frozen, t_s_));
    if (drive_.tick(t_s_)) drive_the_motor("communication timeout");
    drive_the_motor("alarm");
    std::size_t n = std::min(samples, kChunk);
    if (const double left_s = drive_.watchdog_s() - t_s_; left_s * rate_Hz < static_cast<double>(n))
      n = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(left_s * rate_Hz)));
    const double theta_before = plant_.theta_rad();
    const auto got = plant_.run(n, rows_, 0);
    if (!got || *got == 0) return;
    bool following_error = false;
    const auto last_code = static_cast<std::uint16_t>((1U << options_.plant.adc_bits) - 1U);
    for (std::size_t i = 0; i < *got; ++i) {
      t_s_ = static_cast<double>(++index_) / rate_Hz;
      force_N_ = static_cast<double>(rows_.force_ref_N[i]) + weight_N_;
      following_error = following_error || (rows_.status[i] & kRigMotorFault) != 0;
      reference_->row(t_s_, force_N_, (rows_.status[i] & kRigReferenceSaturated) != 0);
      board_.row(t_s_, rows_.adc[i], last_code);
    }
    reference_wire_.send_due(t_s_);
    board_wire_.send_due(t_s_);
    velocity_rad_per_s_ = (plant_.theta_rad() - theta_before) * rate_Hz / static_cast<double>(*got);
    if (stop_s_ >= 0.0 && still_s_ < 0.0 && std::fabs(velocity_rad_per_s_) < 0.01) still_s_ = t_s_;
    drive_.see(plant_.theta_rad(), velocity_rad_per_s_, following_error);
    samples -= *got;
  }
}

std::string TwinHost::status() const {
  std::string cause = stop_cause_;
  std::replace(cause.begin(), cause.end(), ' ', '-');
  return fmt::format(
      "ok t_s={:.6g} theta_rad={:.6g} velocity_rad_per_s={:.6g} force_N={:.6g} command_rad_per_s={:.6g} "
      "alarm={} stop_s={:.6g} still_s={:.6g} stop_cause={} advanced_s={:.6g}",
      t_s_, plant_.theta_rad(), velocity_rad_per_s_, force_N_, told_rad_per_s_, drive_.alarm(), stop_s_,
      still_s_, cause, advanced_s_);
}

}  // namespace forcegate::emulated
