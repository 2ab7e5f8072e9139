// Whether recordings of a free body are of one body at all.
#pragma once

#include <vector>

#include "diagnosis/attitude/recorded_data.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// The bodies that the recordings, fitted and held out, are of: each recording alone gives its
// moments of inertia up to their scale (attitude/estimation/free_inertia.h), and two recordings are
// of different bodies where a moment differs by five standard errors and by a tenth of the mean
// moment; recordings that are not told apart belong together. Recordings that do not determine
// their moments to a twentieth are not compared. Empty where all are of one body, or where the
// platform is not free: then other torques act.
std::vector<BodyOfRecordings> different_bodies(const Platform& platform, const RecordedData& data);

// One sentence for people that names the recordings of each; empty without bodies.
std::string sentence_of(const std::vector<BodyOfRecordings>& bodies);

}  // namespace photorque
