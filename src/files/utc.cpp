// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/utc.hpp"

#include <charconv>
#include <chrono>
#include <regex>

namespace tubefoot {

std::optional<double> unix_time_s(const std::string& utc) {
  static const std::regex form(R"((\d{4})-(\d\d)-(\d\d)T(\d\d):(\d\d):(\d\d(\.\d{1,9})?)Z)");
  std::smatch part;
  if (utc.size() > 40 || !std::regex_match(utc, part, form)) return std::nullopt;
  const auto whole = [&](int k) { return std::stoi(part[k].str()); };
  const std::chrono::year_month_day day{std::chrono::year(whole(1)), std::chrono::month(unsigned(whole(2))),
                                        std::chrono::day(unsigned(whole(3)))};
  double seconds = 0;
  const std::string text = part[6].str();
  std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (!day.ok() || whole(1) < 1970 || whole(1) > 2099 || whole(4) > 23 || whole(5) > 59 || seconds >= 60)
    return std::nullopt;
  return 86400.0 * double(std::chrono::sys_days(day).time_since_epoch().count()) + 3600.0 * whole(4) +
         60.0 * whole(5) + seconds;
}

}  // namespace tubefoot
