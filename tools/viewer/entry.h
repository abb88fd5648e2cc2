// Access control of the server: computes the answer to an HTTP request, without a socket.
// SPDX-License-Identifier: Apache-2.0
//
// - The Host header must name this machine. In a DNS rebinding attack, the name of a foreign web page
//   resolves to this machine's address. The browser then sends the foreign name in the Host header.
// - A request with the token may view and control, whatever its Origin.
// - A request without a token gets only the files of the page, which are the same on every machine. With
//   Access::open, a request without a token may also view. Exception: requests whose Origin is a web page of
//   another server.
// - A request with a wrong token gets only the files of the page, even with Access::open.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tools/viewer/protocol.h"

namespace kaz::viewer {

struct ServedFile {
  std::string type;  // MIME type such as "text/html"
  Bytes bytes;
};

struct Access {
  std::string token;  // expected value of `token=` in the address; empty: no request has the token
  bool open = false;  // true: viewers need no token
  // Names of this machine; IP addresses and "localhost" are always valid.
  std::vector<std::string> names;
  std::map<std::string, ServedFile> page;   // public files by path, such as "/index.html"
  std::map<std::string, ServedFile> robot;  // files for viewers by path, such as "/robot/kaz.urdf"
};

// An HTTP request. If a header is missing or repeated, the member for this header is empty.
struct HttpRequest {
  std::string_view method, target, host, origin, subprotocols;
  bool upgrade = false;  // true: the client requests a WebSocket
};

struct Answer {
  unsigned status = 200;             // 101: the connection becomes a viewer
  std::string_view sentence;         // reason of a refusal, if status is 400 or more
  const ServedFile* file = nullptr;  // file to send, if status is 200
  bool any_origin = false;           // web pages of other servers may read the file
  bool control = false;              // the viewer has the token
  std::string_view subprotocol;      // one of kSubprotocols, if status is 101
};

// Computes the answer to a request. Pure function. The pointers and views in the answer refer to `access` and
// to constants.
Answer answer_to(const HttpRequest& request, const Access& access);

}  // namespace kaz::viewer
