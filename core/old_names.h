// Names of keys and columns that have a successor: still read, with a notice for the user.
#pragma once

#include <string>
#include <vector>

namespace photorque {

// Keeps a notice, "FILE, line 3: …", once however often it is given. From any thread.
void note_old_name(const std::string& notice);

// The notices so far, in order of the first time.
std::vector<std::string> old_name_notices();

}  // namespace photorque
