#include "hil/app/mystery/mystery.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/app/files/write_file.h"
#include "hil/base/digest.h"
#include "hil/base/output_path.h"
#include "hil/base/read_file.h"
#include "hil/base/rng.h"
#include "rigs/emulated/hidden/campaign_maker.h"
#include "rigs/emulated/hidden/campaign_writer.h"
#include "rigs/emulated/hidden/played_forces.h"
#include "rigs/emulated/hidden/seal.h"

namespace forcegate {
namespace {

constexpr double kShareClean = 0.12, kShareForeign = 0.10, kSharePair = 0.08;

const std::string& pick(Rng& rng, const std::vector<std::string>& names) {
  return names[rng.below(names.size())];
}

std::vector<std::string> choose_effects(const MysteryRequest& request, Rng& rng) {
  if (!request.pair.empty()) return request.pair;
  const std::vector<std::string> known = hidden::effect_names(false), foreign = hidden::effect_names(true);
  const double draw = rng.uniform();
  if (request.effect == "none") return {};
  if (request.effect == "foreign") return {pick(rng, foreign)};
  if (!request.effect.empty()) return {request.effect};
  if (draw < kShareClean) return {};
  if (draw < kShareClean + kShareForeign) return {pick(rng, foreign)};
  std::vector<std::string> chosen = {pick(rng, known)};
  if (draw < kShareClean + kShareForeign + kSharePair)
    for (std::string other = chosen[0]; chosen.size() < 2;) {
      other = pick(rng, known);
      if (other != chosen[0]) chosen.push_back(other);
    }
  return chosen;
}

// A campaign that could not be written whole is none: a folder that was made for it goes again.
class NewFolder {
 public:
  explicit NewFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
    std::error_code unknown;
    kept_ = std::filesystem::exists(folder_, unknown);
  }
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;
  ~NewFolder() {
    std::error_code ignored;
    if (!kept_) std::filesystem::remove_all(folder_, ignored);
  }
  void keep() { kept_ = true; }

 private:
  std::filesystem::path folder_;
  bool kept_ = false;
};

}  // namespace

bool is_mystery(const std::filesystem::path& folder) {
  std::error_code ignored;
  return std::filesystem::exists(folder / hidden::kSealedFile, ignored);
}

Result<std::vector<std::string>> play_on_mystery(const std::filesystem::path& folder,
                                                 const std::vector<MysterySegment>& segments) {
  FORCEGATE_TRY(const hidden::SealedSheet sheet, hidden::read_sealed(folder));
  FORCEGATE_TRY(const std::string text, hidden::open(sheet));
  FORCEGATE_TRY(const hidden::Truth truth, hidden::truth_from_json(text));
  FORCEGATE_TRY(const std::string description, read_file(folder / "campaign.json"));
  const auto json = nlohmann::json::parse(description, nullptr, false, true);
  if (json.is_discarded() || !json.contains("records"))
    return fail(ErrorCode::parse, "the campaign's description cannot be read",
                (folder / "campaign.json").string());
  FORCEGATE_TRY(std::vector<hidden::AskedForce> played, hidden::read_played(folder));
  const std::size_t before = json["records"].size();
  std::vector<hidden::AskedForce> asked;
  std::vector<std::string> names;
  for (const MysterySegment& s : segments) {
    asked.push_back({before + asked.size(), s.kind, s.t_s, s.force_N, s.f_min_Hz});
    names.push_back(fmt::format("r{:02d}_{}", before + asked.size(), s.name));
  }
  FORCEGATE_TRY(const hidden::MadeCampaign made, hidden::continue_campaign(truth, played, asked));
  FORCEGATE_TRY(std::vector<std::string> files, hidden::append_records(made, names, folder));
  played.insert(played.end(), asked.begin(), asked.end());
  FORCEGATE_CHECK_OK(hidden::write_played(played, folder));
  return files;
}

std::vector<std::string> mystery_effect_names() {
  std::vector<std::string> names = {"none", "foreign"};
  for (const bool foreign : {false, true})
    for (std::string& name : hidden::effect_names(foreign)) names.push_back(std::move(name));
  return names;
}

Result<MysteryResult> make_mystery(const MysteryRequest& request,
                                   const std::function<void(const std::string&)>& on_commitment) {
  if (!request.pair.empty() && request.pair.size() != 2)
    return fail(ErrorCode::usage, "a pair has two effects", "--pair", "write --pair creep,thermal");
  if (!request.pair.empty() && request.pair[0] == request.pair[1])
    return fail(ErrorCode::usage, "both effects of the pair are " + request.pair[0], "--pair", "a pair has two different effects; for one: --effect " + request.pair[0]);
  if (!request.pair.empty() && !request.effect.empty())
    return fail(ErrorCode::usage, "--pair and --effect exclude each other");
  std::error_code error;
  FORCEGATE_CHECK_OK(output_path(request.folder));
  const std::filesystem::path list = request.folder / "campaign.json";
  if (!request.overwrite && std::filesystem::exists(list, error))
    return fail(ErrorCode::usage, "there is a campaign already", list.string(),
                "choose another folder, or --force");
  Rng rng(request.seed, "mystery");
  hidden::CampaignRequest wanted;
  wanted.seed = request.seed;
  wanted.name = request.folder.filename().empty() ? request.folder.parent_path().filename().string()
                                                  : request.folder.filename().string();
  wanted.effects = choose_effects(request, rng);
  const hidden::Tier drawn[] = {hidden::Tier::weak, hidden::Tier::medium, hidden::Tier::strong};
  wanted.tier = drawn[rng.below(3)];
  if (!request.strength.empty()) {
    FORCEGATE_TRY(wanted.tier, hidden::tier_of(request.strength));
  }
  wanted.minutes = request.minutes;
  FORCEGATE_TRY(const hidden::MadeCampaign made, hidden::make_campaign(wanted));

  const std::string nonce = sha256_hex("nonce/" + std::to_string(request.seed)).substr(0, 32);
  const hidden::SealedSheet sheet = hidden::seal(hidden::to_json(made.truth), nonce);
  const auto interrupted = [&] { return request.interrupted && request.interrupted(); };
  interrupted();  // from here on nothing ends the program without cleaning up
  NewFolder folder(request.folder);
  FORCEGATE_CHECK_OK(make_folder(request.folder));
  FORCEGATE_CHECK_OK(check_writable(request.folder / hidden::kSealedFile));
  if (on_commitment) on_commitment(sheet.commitment);
  FORCEGATE_CHECK_OK(hidden::write_campaign(made, request.folder, request.overwrite, interrupted));
  if (auto sealed = hidden::write_sealed(sheet, request.folder); !sealed) {
    hidden::take_back_campaign(made, request.folder);
    std::filesystem::remove(request.folder / hidden::kSealedFile, error);
    return Unexpected(std::move(sealed).error());
  }
  folder.keep();

  MysteryResult result;
  result.folder = request.folder;
  result.commitment = sheet.commitment;
  result.records = made.records.size();
  for (const hidden::RecordData& record : made.records) result.rows += record.stamp_s.size();
  const hidden::RecordPlan& last = made.records.back().plan;
  result.campaign_minutes = (last.start_s + last.duration_s) / 60.0;
  return result;
}

}  // namespace forcegate
