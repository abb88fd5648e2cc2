// Access control of the server: which answer an HTTP request gets, decided without a socket.
// SPDX-License-Identifier: Apache-2.0
//
// - The Host header must name this machine. A web page that points its own name at this address (DNS
//   rebinding) sends that name.
// - A request with the token may look and control, whatever its Origin.
// - Without a token a request gets the files of the page, which are the same on every machine. With
//   Access::open it may look as well, unless its Origin is a web page of another server.
// - A request with a wrong token is refused.
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
  std::string token;               // the value of `token=` in the address; empty: no request has it
  bool open = false;               // looking needs no token
  std::vector<std::string> names;  // of this machine, beside IP addresses and "localhost"
  std::map<std::string, ServedFile> page;   // public; by path: "/index.html"
  std::map<std::string, ServedFile> robot;  // for viewers: "/robot/kaz.urdf"
};

// A header that is missing, or is there twice, is empty.
struct HttpRequest {
  std::string_view method, target, host, origin, subprotocols;
  bool upgrade = false;  // to a WebSocket
};

struct Answer {
  unsigned status = 200;             // 101: the connection becomes a viewer
  std::string_view sentence;         // of a refusal, status 400 or more
  const ServedFile* file = nullptr;  // of status 200
  bool any_origin = false;           // web pages of other servers may read the file
  bool control = false;              // the viewer has the token
  std::string_view subprotocol;      // the viewer's, one of kSubprotocols
};

// Reads nothing but its arguments. The answer points into `access` and into constants.
Answer answer_to(const HttpRequest& request, const Access& access);

}  // namespace kaz::watch
