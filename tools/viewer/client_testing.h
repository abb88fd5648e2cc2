// For tests: a client of the server with blocking WebSocket calls, based on Boost.Beast.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>

#include "tools/viewer/protocol.h"

namespace kaz::viewer {

class Client {
 public:
  explicit Client(std::uint16_t port) : port_(port) {
    boost::beast::get_lowest_layer(socket_).connect(
        {boost::asio::ip::make_address("127.0.0.1"), port});
  }

  // Opens the WebSocket. Returns the chosen subprotocol. nullopt: the server refused the handshake.
  std::optional<std::string> open(const std::string& offered, const std::string& target = "/") {
    socket_.set_option(boost::beast::websocket::stream_base::decorator(
        [&](boost::beast::websocket::request_type& request) {
          if (!offered.empty())
            request.set(boost::beast::http::field::sec_websocket_protocol, offered);
        }));
    boost::beast::websocket::response_type response;
    boost::system::error_code error;
    socket_.handshake(response, "127.0.0.1:" + std::to_string(port_), target, error);
    if (error) return std::nullopt;
    return std::string(response[boost::beast::http::field::sec_websocket_protocol]);
  }

  void send(const std::string& text) {
    socket_.text(true);
    socket_.write(boost::asio::buffer(text));
  }
  void send(const nlohmann::json& object) { send(object.dump()); }
  void send(const Bytes& bytes) {
    socket_.binary(true);
    socket_.write(boost::asio::buffer(bytes));
  }

  // Returns the next message. nullopt: the connection has ended.
  std::optional<Bytes> next() {
    boost::beast::flat_buffer buffer;
    boost::system::error_code error;
    socket_.read(buffer, error);
    if (error) return std::nullopt;
    const auto* data = static_cast<const std::uint8_t*>(buffer.data().data());
    return Bytes(data, data + buffer.size());
  }
  bool is_text() const { return socket_.got_text(); }
  // Returns the next text message whose member `op` equals the argument. Skips other messages before that
  // message. Null: the connection has ended.
  nlohmann::json next_op(const std::string& op) {
    while (const auto message = next()) {
      if (!is_text()) continue;
      auto object = nlohmann::json::parse(*message, nullptr, false);
      if (object.value("op", "") == op) return object;
    }
    return nullptr;
  }
  // Returns the next binary message with this opcode. Skips other messages before that message. nullopt: the
  // connection has ended.
  std::optional<Bytes> next_frame(std::uint8_t opcode) {
    while (auto message = next()) {
      if (!is_text() && !message->empty() && message->front() == opcode) return message;
    }
    return std::nullopt;
  }
  // Returns the number of the channel with this topic. Waits until the server has advertised the channel.
  std::uint32_t channel(const std::string& topic) {
    while (!channels_.contains(topic)) {
      const auto object = next_op("advertise");
      if (object.is_null()) return 0xffffffff;
      for (const auto& one : object["channels"])
        channels_[one["topic"].get<std::string>()] = one["id"].get<std::uint32_t>();
    }
    return channels_[topic];
  }
  boost::asio::ip::tcp::socket& raw() { return socket_.next_layer(); }

 private:
  std::uint16_t port_;
  boost::asio::io_context io_;
  boost::beast::websocket::stream<boost::asio::ip::tcp::socket> socket_{io_};
  std::map<std::string, std::uint32_t> channels_;
};

inline std::string get(const std::string& path) {
  return "GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n";
}

// Returns the whole answer to `request`. Reads until the connection ends.
inline std::string answer(std::uint16_t port, const std::string& request) {
  boost::asio::io_context io;
  boost::asio::ip::tcp::socket socket(io);
  socket.connect({boost::asio::ip::make_address("127.0.0.1"), port});
  boost::system::error_code error;
  boost::asio::write(socket, boost::asio::buffer(request), error);
  std::string text;
  boost::asio::read(socket, boost::asio::dynamic_buffer(text), error);
  return text;
}

}  // namespace kaz::viewer
