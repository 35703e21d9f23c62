#include "pipeline/play/serve.h"

#include <fmt/format.h>
#include <httplib.h>

#include <array>
#include <csignal>
#include <string_view>
#include <thread>

#include "mesh/errors.h"

namespace palpate::pipeline {
namespace {

/// Was the page asked for under a name of this machine? Another name that leads here is a trick on the browser.
bool is_own_name(std::string host) {
    if (const std::size_t port = host.find_last_of(':'); port != std::string::npos && host.back() != ']')
        host.resize(port);
    constexpr std::array<std::string_view, 3> own{"127.0.0.1", "localhost", "[::1]"};
    return std::find(own.begin(), own.end(), host) != own.end();
}

}  // namespace

void serve(const std::string& page, int port, const std::function<void(int port)>& ready) {
    // Ctrl-C is waited for below: no thread that begins from here on is interrupted by it.
    sigset_t ends;
    sigemptyset(&ends);
    sigaddset(&ends, SIGINT);
    sigaddset(&ends, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &ends, nullptr);

    httplib::Server server;
    server.set_pre_routing_handler([](const httplib::Request& request, httplib::Response& response) {
        if (is_own_name(request.get_header_value("Host"))) return httplib::Server::HandlerResponse::Unhandled;
        response.status = 403;
        return httplib::Server::HandlerResponse::Handled;
    });
    server.set_default_headers({{"Cache-Control", "no-store"}, {"X-Content-Type-Options", "nosniff"}});
    server.Get("/", [&](const httplib::Request&, httplib::Response& response) {
        response.set_content(page, "text/html; charset=utf-8");
    });
    // A port that another program listens at is not taken over.
    server.set_socket_options([](socket_t) {});
    const int bound =
        port == 0 ? server.bind_to_any_port("127.0.0.1") : (server.bind_to_port("127.0.0.1", port) ? port : -1);
    if (bound < 0) {
        throw InvalidInput(fmt::format(
            "--port is {}: it is in use or not allowed; choose another one, or leave it out for a free one", port));
    }
    std::thread listening([&] { server.listen_after_bind(); });
    ready(bound);
    int signal = 0;
    sigwait(&ends, &signal);
    server.stop();
    listening.join();
}

}  // namespace palpate::pipeline
