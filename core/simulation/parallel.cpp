#include "core/simulation/parallel.h"

#include <algorithm>

namespace sluice {

namespace {
int threads_in_use = 1;
}

int thread_count() { return threads_in_use; }

void set_thread_count(int threads) { threads_in_use = std::max(1, threads); }

}  // namespace sluice
