#pragma once
// Path data in tenths of a pixel, relative and with the fewest separators: about five bytes a point.

#include <cmath>
#include <span>
#include <string>

#include "hil/report/figures/decimate.h"

namespace forcegate::figures {

class PathData {
 public:
  void move(double x_px, double y_px) { to(x_px, y_px, 'm'); }
  void line(double x_px, double y_px) { to(x_px, y_px, 'l'); }
  void close() {
    text_ += 'z';
    x_ = start_x_;
    y_ = start_y_;
    command_ = 'z';
  }
  /// A zero-length stroke: a dot when the line caps are round.
  void dot(double x_px, double y_px) {
    to(x_px, y_px, 'm');
    text_ += "h0";
    command_ = 'h';
  }
  void rectangle(double x_px, double y_px, double w_px, double h_px) {
    move(x_px, y_px);
    line(x_px + w_px, y_px);
    line(x_px + w_px, y_px + h_px);
    line(x_px, y_px + h_px);
    close();
  }
  const std::string& text() const { return text_; }
  bool empty() const { return text_.empty(); }

 private:
  void number(long v, bool first) {
    if (!first && v >= 0) text_ += ' ';
    text_ += std::to_string(v);
  }
  void to(double x_px, double y_px, char command) {
    const long x = std::lround(x_px * 10.0), y = std::lround(y_px * 10.0);
    const bool repeat = command == 'l' && command_ == 'l';
    if (!repeat) text_ += text_.empty() ? 'M' : command;
    number(x - x_, !repeat);
    number(y - y_, false);
    x_ = x;
    y_ = y;
    if (command == 'm') {
      start_x_ = x;
      start_y_ = y;
    }
    command_ = command;
  }
  std::string text_;
  long x_ = 0, y_ = 0, start_x_ = 0, start_y_ = 0;
  char command_ = 0;
};

}  // namespace forcegate::figures
