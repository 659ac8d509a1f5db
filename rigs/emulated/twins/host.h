#pragma once
// The emulated bench with a wire to every instrument: one plant, one drive, one ATI reference, one board, one clock.
// A harness, a person with a terminal program or any other program talks to the wires; a Unix socket `control` in the
// same folder moves time, mounts specimens, flashes the board and injects faults, one line of text each:
//
//   mount specimen=q50 seed=1 session=0 record=1 rest_s=7200 low_N=0 high_N=4
//   flash PATH | attach DEVICE | advance SAMPLES device=received ... | status | fault DEVICE KIND AT FOR COUNT AMOUNT | load NEWTONS (a weight on the reference)
//
// Time is virtual while a client that has said `advance` is connected, else it is that of the clock on the wall: when a
// harness dies, the plant and the drive's watchdog go on.

#include <atomic>
#include <chrono>
#include <filesystem>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "hil/base/config_node.h"
#include "hil/interface/rig.h"
#include "rigs/emulated/emulated_rig.h"
#include "rigs/emulated/twins/board.h"
#include "rigs/emulated/twins/drive.h"
#include "rigs/emulated/twins/reference_twin.h"

namespace forcegate::emulated {

struct TwinOptions {
  EmulatedOptions plant;
  bool tcp = true;
  int tcp_port = 0, slave = 1;
  std::string motor_port = "motor0", reference_port = "ati0", board_port = "board0";
  ReferenceTwinOptions reference;
  bool board_reports = false;  ///< HID: 64-byte reports on the board's terminal
  std::vector<FaultEntry> faults;
};

/// What a bench file says about its twins.
Result<TwinOptions> read_twin_options(const ConfigNode& bench);

class TwinHost {
 public:
  /// Opens all wires in `folder`; takes away what it published there when it goes. Errors: config, where another host serves in that folder.
  static Result<std::unique_ptr<TwinHost>> make(const TwinOptions& options,
                                                const std::filesystem::path& folder);
  ~TwinHost();

  /// Serves until `stop` is set or, with `until_alone`, the last control client has gone.
  void serve(const std::atomic<bool>& stop, bool until_alone);

  std::vector<std::string> endpoints() const;  ///< "motor: tcp 127.0.0.1:40231" ...

 private:
  explicit TwinHost(const TwinOptions& options);
  struct Client {
    Descriptor fd;
    std::string pending;
    bool master = false;
  };
  Result<void> open(const std::filesystem::path& folder);
  void wait_for_events(double longest_s);
  void receive_all();
  void obey(Client& client);
  std::string execute(Client& client, const std::string& line);
  std::string mount(const std::vector<std::string>& words);
  std::string advance(const std::vector<std::string>& words);
  std::string fault(const std::vector<std::string>& words);
  std::string status() const;
  void pace();
  void step(std::size_t samples);
  void drive_the_motor(const char* cause);
  Wire* wire_of(const std::string& device);

  TwinOptions options_;
  FaultScript faults_;
  EmulatedRig plant_;
  Drive drive_;
  Wire motor_wire_, reference_wire_, board_wire_;
  Wire page_wire_;  ///< web page of a Net F/T
  ModbusServer modbus_;
  std::unique_ptr<ReferenceTwin> reference_;
  Board board_;
  Descriptor listener_;
  std::list<Client> clients_;
  bool had_client_ = false;
  RigBlock rows_;
  std::int64_t index_ = 0;
  double t_s_ = 0.0, told_rad_per_s_ = 0.0, velocity_rad_per_s_ = 0.0, force_N_ = 0.0, weight_N_ = 0.0;
  double stop_s_ = -1.0, still_s_ = -1.0;
  double advanced_s_ = -1.0;  ///< of the board's stream, when a client last moved time
  std::string stop_cause_ = "none";
  std::chrono::steady_clock::time_point paced_at_;
  double paced_rest_ = 0.0;
  int tcp_port_ = 0;
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> published_;  ///< links, ports and the socket: gone with the host
};

}  // namespace forcegate::emulated
