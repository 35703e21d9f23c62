#include "pipeline/run/folder/run_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <openssl/evp.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <memory>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/unfinished.h"
#include "pipeline/run/folder/peak_memory.h"
#include "pipeline/version.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* record_name = "run.json";
constexpr const char* lock_name = ".lock";

class Sha256 {
public:
    Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) { EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr); }
    void add(const char* bytes, std::size_t count) { EVP_DigestUpdate(context_.get(), bytes, count); }
    std::string hex() {
        std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
        unsigned length = 0;
        EVP_DigestFinal_ex(context_.get(), digest.data(), &length);
        std::string text;
        for (unsigned i = 0; i < length; ++i) text += fmt::format("{:02x}", digest[i]);
        return text;
    }

private:
    std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

/// SHA-256 of a file, or of the names and digests of all that a folder holds.
std::string digest(const fs::path& output) {
    if (!fs::is_directory(output)) return sha256_of_file(output);
    std::vector<std::string> lines;
    for (const auto& entry : fs::recursive_directory_iterator(output)) {
        if (!entry.is_regular_file()) continue;
        lines.push_back(fs::relative(entry.path(), output).string() + " " + sha256_of_file(entry.path()));
    }
    std::sort(lines.begin(), lines.end());
    return sha256(fmt::format("{}", fmt::join(lines, "\n")));
}

json digests(const fs::path& folder, const std::vector<fs::path>& outputs) {
    json result = json::object();
    for (const fs::path& output : outputs) result[output.string()] = digest(folder / output);
    return result;
}

bool untouched(const fs::path& folder, const json& outputs) {
    for (const auto& [output, expected] : outputs.items()) {
        if (!fs::exists(folder / output) || digest(folder / output) != expected) return false;
    }
    return true;
}

/// The folder's lock file, opened and locked; the lock ends with the process, however that ends.
int lock(const fs::path& folder) {
    const fs::path file = folder / lock_name;
    while (true) {
        const int lock = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
        if (lock < 0) throw IoError(fmt::format("{}: cannot be written into", folder.string()));
        if (flock(lock, LOCK_EX | LOCK_NB) != 0) {
            close(lock);
            throw InvalidInput(
                fmt::format("{}: another palpate works in this folder; wait for it, or name another folder with -o",
                            folder.string()));
        }
        // a run that ends takes its file away: what counts is the one that stands there
        struct stat opened {
        }, standing{};
        if (fstat(lock, &opened) == 0 && stat(file.c_str(), &standing) == 0 && opened.st_ino == standing.st_ino) {
            return lock;
        }
        close(lock);
    }
}

/// Whether it holds files that no run leaves: one that was killed as it began leaves a lock and half a record.
bool holds_others(const fs::path& folder) {
    return std::any_of(fs::directory_iterator(folder), fs::directory_iterator(), [](const fs::directory_entry& entry) {
        return entry.path().filename() != lock_name && !mesh::is_unfinished(entry.path());
    });
}

/// Takes away what a killed run had half written beside its targets.
void remove_remains(const fs::path& folder) {
    std::vector<fs::path> remains;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (mesh::is_unfinished(entry.path())) remains.push_back(entry.path());
    }
    std::error_code ignored;
    for (const fs::path& path : remains) fs::remove_all(path, ignored);
}

/// What the runs before wrote down; null where no record of ours stands.
json read_record(const fs::path& file) {
    if (!fs::exists(file)) return {};
    try {
        const json record = json::parse(mesh::read_text(file));
        return record.value("program", "") == "palpate" ? record : json();
    } catch (const json::exception&) {
        return {};
    }
}

}  // namespace

RunFolder::RunFolder(fs::path folder, bool force) : folder_(std::move(folder)) {
    if (fs::exists(folder_) && !fs::is_directory(folder_)) {
        throw InvalidInput(fmt::format("{}: is a file; name a folder for the run", folder_.string()));
    }
    const bool has_record = !read_record(folder_ / record_name).is_null();
    if (!has_record && !force && fs::exists(folder_) && holds_others(folder_)) {
        throw InvalidInput(
            fmt::format("{}: the folder holds files that palpate did not make; name another one, or say "
                        "--force to write into it",
                        folder_.string()));
    }
    std::error_code failed;
    fs::create_directories(folder_, failed);
    if (failed) throw IoError(fmt::format("{}: cannot be made: {}", folder_.string(), failed.message()));

    lock_ = lock(folder_);
    remove_remains(folder_);
    record_ = read_record(folder_ / record_name);  // as it is now that nobody else writes it
    if (record_.is_null()) record_ = json::object();
    record_["program"] = "palpate";
    record_["version"] = version;
    if (!record_.contains("stages")) record_["stages"] = json::object();
    save();
}

RunFolder::~RunFolder() {
    std::error_code ignored;
    fs::remove(folder_ / lock_name, ignored);
    close(lock_);
}

bool RunFolder::stage(const StagePlan& plan, const std::function<json()>& work) {
    const std::string key = key_of(plan);
    const json before = record_["stages"].value(plan.name, json::object());
    if (before.value("key", "") == key && untouched(folder_, before["outputs"])) return false;

    record_["stages"].erase(plan.name);
    save();
    const auto start = std::chrono::steady_clock::now();
    reset_peak_memory();
    const json figures = work();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    record_["stages"][plan.name] = {{"key", key},
                                    {"seconds", seconds},
                                    {"peak_memory_mb", peak_memory_mb()},
                                    {"figures", figures},
                                    {"outputs", digests(folder_, plan.outputs)}};
    save();
    return true;
}

void RunFolder::drop(const std::string& stage, const std::vector<fs::path>& outputs) {
    if (record_["stages"].erase(stage) > 0) save();
    for (const fs::path& output : outputs) fs::remove(folder_ / output);
}

void RunFolder::note(const std::string& key, const json& value) {
    record_[key] = value;
    save();
}

void RunFolder::save() const { mesh::write_text(folder_ / record_name, record_.dump(2) + "\n"); }

std::string RunFolder::key_of(const StagePlan& plan) const {
    json all = {{"version", version}, {"stage", plan.name}, {"settings", plan.settings}};
    for (const fs::path& input : plan.inputs) all["inputs"].push_back(sha256_of_file(input));
    for (const std::string& stage : plan.after) all["after"].push_back(record_["stages"][stage]["key"]);
    return sha256(all.dump());
}

std::string sha256(const std::string& bytes) {
    Sha256 sum;
    sum.add(bytes.data(), bytes.size());
    return sum.hex();
}

std::string sha256_of_file(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw IoError(fmt::format("{}: cannot be opened", file.string()));
    Sha256 sum;
    std::array<char, 1 << 16> buffer{};
    while (in.read(buffer.data(), buffer.size()) || in.gcount() > 0) {
        sum.add(buffer.data(), static_cast<std::size_t>(in.gcount()));
    }
    return sum.hex();
}

}  // namespace palpate::pipeline
