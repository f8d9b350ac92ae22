#pragma once

#include <functional>

namespace puppetwarp {

//! Sets how many threads all of puppetwarp's parallel loops in this process use, at most one a core; 0 or less: all
//! cores. Results do not depend on it, to the bit.
void set_thread_count(int count);

//! How many threads parallel loops use now, at least 1.
int thread_count();

//! Calls `body(first, last)` for consecutive ranges that cover [begin, end), in parallel, each of `grain` indices
//! but for the last. The ranges depend on `grain` alone, never on the number of threads.
//! \param grain  at least 1.
//! An exception thrown by `body` is rethrown here (the one of the lowest range).
void parallel_for(int begin, int end, int grain, const std::function<void(int first, int last)>& body);

}  // namespace puppetwarp
