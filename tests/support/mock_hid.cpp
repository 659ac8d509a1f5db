#include "tests/support/mock_hid.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <umockdev.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>

namespace forcegate::test {
namespace {

// Usage page 0xFF00, one input and one output report of 64 bytes, unnumbered.
const std::string kDescriptor = "0600FF0901A101150026FF007508954009018102954009029102C0";
constexpr std::size_t kDescriptorField = 4096, kQueueMax = 512;

std::string text(const char* format, unsigned a, unsigned b) {
  char out[128];
  std::snprintf(out, sizeof out, format, a, b);
  return out;
}

}  // namespace

struct MockHid::Testbed {
  UMockdevTestbed* bed = nullptr;
  ~Testbed() { g_clear_object(&bed); }
};

Result<std::unique_ptr<MockHid>> MockHid::plug_in(unsigned short vendor, unsigned short product,
                                                  const std::string& serial, const std::string& folder) {
  const char* preloaded = getenv("LD_PRELOAD");
  if (preloaded == nullptr || std::string(preloaded).find("umockdev") == std::string::npos)
    return fail(ErrorCode::usage, "not inside umockdev-wrapper");
  const std::string usb = "/devices/pci0000:00/usb1/1-1", interface = usb + "/1-1:1.0";
  const std::string hid = interface + text("/0003:%04X:%04X.0001", vendor, product);
  const std::string device =
      "P: " + hid +
      "/hidraw/hidraw0\nN: hidraw0\nE: DEVNAME=/dev/hidraw0\nE: SUBSYSTEM=hidraw\nE: MAJOR=240\nE: MINOR=0\nL: device=../../../" +
      hid.substr(hid.rfind('/') + 1) + "\n\nP: " + hid +
      "\nE: SUBSYSTEM=hid\nE: DRIVER=hid-generic\nE: HID_ID=" + text("0003:%08X:%08X", vendor, product) +
      "\nE: HID_NAME=Forcegate sensor board\nE: HID_PHYS=usb-1/input0\nE: HID_UNIQ=" + serial +
      "\nH: report_descriptor=" + kDescriptor + "\n\nP: " + interface +
      "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_interface\nE: DRIVER=usbhid\nA: bInterfaceNumber=00\\n\n\nP: " +
      usb + "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: DRIVER=usb\nA: idVendor=" +
      text("%04x\\n\nA: idProduct=%04x\\n\n", vendor, product) +
      "A: manufacturer=Forcegate\\n\nA: product=sensor board\\n\nA: serial=" + serial +
      "\\n\nA: bcdDevice=0100\\n\n\n";
  std::unique_ptr<MockHid> mock(new MockHid());
  mock->testbed_ = std::make_unique<Testbed>();
  mock->testbed_->bed = umockdev_testbed_new();
  GError* error = nullptr;
  const auto refused = [&](const char* what) {
    const std::string why = error != nullptr ? error->message : "";
    g_clear_error(&error);
    return fail(ErrorCode::internal, std::string(what) + ": " + why);
  };
  if (!umockdev_testbed_add_from_string(mock->testbed_->bed, device.c_str(), &error))
    return refused("no device");
  const std::string size = text("%02X000000", static_cast<unsigned>(kDescriptor.size() / 2), 0);
  std::string field = size + kDescriptor;
  field.resize(2 * (4 + kDescriptorField), '0');
  const std::string script = folder + "/hidraw.ioctl";
  std::ofstream(script) << "@DEV /dev/hidraw0\nHIDIOCGRDESCSIZE 0 " << size << "\nHIDIOCGRDESC 0 " << field
                        << "\n";
  if (!umockdev_testbed_load_ioctl(mock->testbed_->bed, "/dev/hidraw0", script.c_str(), &error))
    return refused("no ioctls");
  mock->master_ = umockdev_testbed_get_dev_fd(mock->testbed_->bed, "/dev/hidraw0");
  if (mock->master_ < 0) return refused("no end to play the device with");
  fcntl(mock->master_, F_SETFL, O_NONBLOCK);
  mock->keeper_ = open(ptsname(mock->master_), O_RDWR | O_NOCTTY);
  return mock;
}

MockHid::~MockHid() {
  if (keeper_ >= 0) close(keeper_);
}

std::vector<std::vector<std::uint8_t>> MockHid::written() {
  std::uint8_t bytes[4096];
  for (ssize_t n; (n = ::read(master_, bytes, sizeof bytes)) > 0;)
    pending_.insert(pending_.end(), bytes, bytes + n);
  std::vector<std::vector<std::uint8_t>> reports;
  while (pending_.size() >= 65) {  // the kernel would take the report number off
    reports.emplace_back(pending_.begin() + 1, pending_.begin() + 65);
    pending_.erase(pending_.begin(), pending_.begin() + 65);
  }
  return reports;
}

bool MockHid::send(const std::vector<std::uint8_t>& report) {
  int queued = 0;  // past umockdev, which takes every ioctl for one of the device
  if (syscall(SYS_ioctl, keeper_, FIONREAD, &queued) != 0 ||
      static_cast<std::size_t>(queued) + report.size() > kQueueMax)
    return false;
  return ::write(master_, report.data(), report.size()) == static_cast<ssize_t>(report.size());
}

void MockHid::pull_out() {
  close(keeper_);
  keeper_ = -1;
  close(master_);
  umockdev_testbed_remove_device(testbed_->bed, "/sys/devices/pci0000:00/usb1/1-1");
}

}  // namespace forcegate::test
