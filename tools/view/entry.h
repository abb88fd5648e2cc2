// Access control of the server: decides the answer to an HTTP request, without a socket.
// SPDX-License-Identifier: Apache-2.0
//
// - The Host header must name this machine. A web page that points its own name at this address (DNS
//   rebinding) sends that name.
// - A request with the token may view and control, whatever its Origin.
// - A request without a token gets the files of the page, which are the same on every machine. With
//   Access::open it may also view, unless its Origin is a web page of another server.
// - A request with a wrong token only gets the files of the page, even with Access::open.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tools/view/protocol.h"

namespace kaz::watch {

struct ServedFile {
  std::string type;  // "text/html"
  Bytes bytes;
};

struct Access {
  std::string token;               // value of `token=` in the address; empty: matches no request
  bool open = false;               // viewing needs no token
  std::vector<std::string> names;  // names of this machine, besides IP addresses and "localhost"
  std::map<std::string, ServedFile> page;   // public; by path: "/index.html"
  std::map<std::string, ServedFile> robot;  // for viewers: "/robot/kaz.urdf"
};

// Headers that are missing or repeated are empty.
struct HttpRequest {
  std::string_view method, target, host, origin, subprotocols;
  bool upgrade = false;  // to a WebSocket
};

struct Answer {
  unsigned status = 200;             // 101: the connection becomes a viewer
  std::string_view sentence;         // reason of a refusal, with status 400 or more
  const ServedFile* file = nullptr;  // with status 200
  bool any_origin = false;           // web pages of other servers may read the file
  bool control = false;              // the viewer has the token
  std::string_view subprotocol;      // with status 101: one of kSubprotocols
};

// Pure function. The answer points into `access` and into constants.
Answer answer_to(const HttpRequest& request, const Access& access);

}  // namespace kaz::watch
