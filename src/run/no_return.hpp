// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "run/run_request.hpp"
#include "run/survey.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// A sensor that receives nothing.
struct NoReturn {
  std::size_t sensor = 0;  ///< index in the survey
  std::string warning;     ///< which, where, why, and what to do, in the scene's terms
};

/// Sensors whose tubes meet no facet within their window at any of a few pings, spread over their track. Of a
/// sensor that may receive by mirrors, direct sound or several scatterings nothing is expected. Makes the
/// ground of these pings where each transmission has its own, and reads their tiles. Throws InputError as
/// Transmission::ground().
std::vector<NoReturn> expected_no_returns(const Survey& survey, const RunRequest& request);

/// Sensors all of whose samples are 0; reads recordings up to the first that is not.
std::vector<NoReturn> met_no_returns(const Survey& survey, const RunRequest& request,
                                     const std::vector<Recording>& recordings);

}  // namespace tubefoot
