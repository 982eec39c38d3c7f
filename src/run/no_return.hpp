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
  std::string warning;     ///< sensor, place, reason and remedy, in the terms of the scene file
};

/// Returns the sensors whose tubes meet no facet within their range gate, at any of a few pings spread over
/// their track. Skips sensors that may receive by mirrors, direct sound or several scatterings. Computes the
/// surface meshes of these pings if each transmission has its own, and reads their tiles. Throws InputError
/// as Transmission::surface_mesh().
std::vector<NoReturn> expected_no_returns(const Survey& survey, const RunRequest& request);

/// Returns the sensors whose samples are all 0. Reads each recording up to its first sample that is not 0.
std::vector<NoReturn> met_no_returns(const Survey& survey, const RunRequest& request,
                                     const std::vector<Recording>& recordings);

}  // namespace tubefoot
