// Bytes sent at TxD0, decoded from its edges.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/txd_watch.h"

namespace kaz::sim {
namespace {

bool line_level(bool level, h8s::Driver driver) {
  return driver == h8s::Driver::nobody || level;
}

}  // namespace

TxdWatch::TxdWatch(H8Mcu& mcu) : mcu_(mcu) {
  restart();
  const auto changed = [this](const h8s::PinEdge& edge) {
    decoder_.level(line_level(edge.level, edge.driver), mcu_.now() - mcu_.chip().now() + edge.at);
  };
  watch_ = mcu_.chip().watch(h8s::Pin::p50, changed, true);
}

TxdWatch::~TxdWatch() {
  mcu_.chip().unwatch(watch_);
}

std::vector<DecodedByte> TxdWatch::take() {
  // The chip stops between two instructions: edges during the last one have not been reported yet.
  decoder_.advance(mcu_.now() - KZ_STATES_PER_BIT);
  return decoder_.take();
}

void TxdWatch::restart() {
  const h8s::PinState state = mcu_.chip().state(h8s::Pin::p50);
  decoder_.restart(line_level(state.level, state.driver));
}

}  // namespace kaz::sim
