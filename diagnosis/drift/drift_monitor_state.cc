#include "diagnosis/drift/drift_monitor.h"
#include "diagnosis/drift/serial.h"

namespace hydroscope::drift {
namespace {

constexpr std::uint32_t kStateMagic = 0x4d524448;  // "HDRM"
constexpr std::uint32_t kMostMembers = 100;

void PutFinding(ByteWriter& out, const DriftFinding& f) {
  out.Put(f.number);
  out.Put(f.state);
  PutText(out, f.rule);
  for (const Told* told :
       {&f.name, &f.guidance, &f.compared.text, &f.compared.cause_title, &f.compared.advice}) {
    PutText(out, told->english);
    PutText(out, told->german);
  }
  out.Put(f.severity);
  out.Put(f.since);
  out.Put(f.found);
  out.Put(f.last);
  out.Put(f.oil_temperature);
  out.Put(f.alarm);
  out.Put(f.quiet);
  out.Put(f.explained);
  out.Put(f.compared.settled);
  out.Put(f.compared.described);
  out.Put(f.beside_another);
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(f.parts.size()));
  for (const FindingPart& part : f.parts) {
    PutText(out, part.quantity);
    PutText(out, part.unit);
    for (const double v : {part.size, part.std, part.reference, part.limit}) out.Put(v);
    out.Put(part.alarm);
  }
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(f.rivals.size()));
  for (const std::string& rival : f.rivals) PutText(out, rival);
  out.Put(f.compared.cause.kind);
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(f.compared.cause.effects.size()));
  for (const std::string& effect : f.compared.cause.effects) PutText(out, effect);
}

DriftFinding GetFinding(ByteReader& in) {
  DriftFinding f;
  f.number = in.Get<std::int64_t>();
  f.state = in.Get<FindingState>();
  f.rule = GetText(in);
  for (Told* told : {&f.name, &f.guidance, &f.compared.text, &f.compared.cause_title, &f.compared.advice}) {
    told->english = GetText(in);
    told->german = GetText(in);
  }
  f.severity = in.Get<RuleSeverity>();
  f.since = in.Get<ChangeTime>();
  f.found = in.Get<std::int64_t>();
  f.last = in.Get<std::int64_t>();
  f.oil_temperature = in.Get<double>();
  f.alarm = in.Get<bool>();
  f.quiet = in.Get<int>();
  f.explained = in.Get<std::int64_t>();
  f.compared.settled = in.Get<bool>();
  f.compared.described = in.Get<bool>();
  f.beside_another = in.Get<bool>();
  for (auto left = in.Get<std::uint32_t>(); left > 0 && in.ok(); --left) {
    FindingPart part;
    part.quantity = GetText(in);
    part.unit = GetText(in);
    for (double* v : {&part.size, &part.std, &part.reference, &part.limit}) *v = in.Get<double>();
    part.alarm = in.Get<bool>();
    f.parts.push_back(std::move(part));
  }
  for (auto left = in.Get<std::uint32_t>(); left > 0 && in.ok(); --left) f.rivals.push_back(GetText(in));
  f.compared.cause.kind = in.Get<CauseKind>();
  for (auto left = in.Get<std::uint32_t>(); left > 0 && in.ok(); --left)
    f.compared.cause.effects.push_back(GetText(in));
  return f;
}

void PutStroke(ByteWriter& out, const StrokeEvidence& s) {
  out.Put(s.sequence);
  for (const double v : {s.time, s.oil_temperature}) out.Put(v);
  out.Put(s.conditions);
  PutVector(out, s.equations.h.reshaped());
  PutVector(out, s.equations.g);
  out.Put(s.equations.yy);
  out.Put(s.equations.equations);
}

StrokeEvidence GetStroke(ByteReader& in) {
  StrokeEvidence s;
  s.sequence = in.Get<std::int64_t>();
  for (double* v : {&s.time, &s.oil_temperature}) *v = in.Get<double>();
  s.conditions = in.Get<decltype(s.conditions)>();
  const Eigen::VectorXd packed = GetVector(in);
  s.equations.g = GetVector(in);
  const auto n = s.equations.g.size();
  s.equations.h = packed.size() == n * n ? Eigen::MatrixXd(packed.reshaped(n, n)) : Eigen::MatrixXd(0, 0);
  s.equations.yy = in.Get<double>();
  s.equations.equations = in.Get<double>();
  return s;
}

}  // namespace

void DriftMonitor::Save(ByteWriter& out) const {
  out.Put(kStateMagic);
  out.Put(kFormat);
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(model_.size()));
  reference_.Save(out);
  for (const CumulativeSum& test : tests_) out.Put(test);
  for (const SlowTrend& trend : trends_) trend.Save(out);
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(strokes_.size()));
  for (const JudgedStroke& s : strokes_) {
    out.Put(s.sequence);
    out.Put(s.operating_class);
    PutVector(out, s.score);
    PutVector(out, s.information.reshaped());
    PutVector(out, s.offset_doubt);
    PutVector(out, s.outside_doubt);
  }
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(findings_.size()));
  for (const DriftFinding& f : findings_) PutFinding(out, f);
  for (const Eigen::VectorXd* v : {&explained_, &recent_score_, &doubt_, &healthy_}) PutVector(out, *v);
  PutVector(out, recent_information_.reshaped());
  out.Put(found_);
  candidates_.Save(out);
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(new_classes_.size()));
  for (const auto& [index, members] : new_classes_) {
    out.Put(index);
    out.Put<std::uint32_t>(static_cast<std::uint32_t>(members.size()));
    for (const StrokeEvidence& s : members) PutStroke(out, s);
  }
}

std::optional<DriftMonitor> DriftMonitor::Restored(WatchedModel model, const RuleBook& rules,
                                                   ByteReader& in) {
  if (in.Get<std::uint32_t>() != kStateMagic || in.Get<std::uint32_t>() != kFormat) return std::nullopt;
  if (in.Get<std::uint32_t>() != static_cast<std::uint32_t>(model.size())) return std::nullopt;
  Reference reference;
  if (!reference.Restore(in) || static_cast<int>(reference.curves().size()) != model.size())
    return std::nullopt;
  DriftMonitor monitor(std::move(model), rules, std::move(reference));
  if (!monitor.RestoreRest(in)) return std::nullopt;
  return monitor;
}

bool DriftMonitor::RestoreRest(ByteReader& in) {
  const auto n = static_cast<Eigen::Index>(model_.size());
  for (CumulativeSum& test : tests_) test = in.Get<CumulativeSum>();
  for (SlowTrend& trend : trends_)
    if (!trend.Restore(in)) return false;
  for (auto left = in.Get<std::uint32_t>(); left > 0 && in.ok(); --left) {
    JudgedStroke s;
    s.sequence = in.Get<std::int64_t>();
    s.operating_class = in.Get<int>();
    s.score = GetVector(in);
    const Eigen::VectorXd packed = GetVector(in);
    s.offset_doubt = GetVector(in);
    s.outside_doubt = GetVector(in);
    if (s.score.size() != n || packed.size() != n * n || s.offset_doubt.size() != n ||
        s.outside_doubt.size() != n)
      return false;
    s.information = packed.reshaped(n, n);
    strokes_.push_back(std::move(s));
  }
  for (auto left = in.Get<std::uint32_t>(); left > 0 && in.ok(); --left) findings_.push_back(GetFinding(in));
  for (DriftFinding& finding : findings_)
    for (FindingPart& part : finding.parts)
      for (const Quantity& quantity : model_.quantities())
        if (quantity.name == part.quantity) {
          part.share = quantity.share;
          part.title = quantity.title;
          part.relative = quantity.relative;
        }
  for (Eigen::VectorXd* v : {&explained_, &recent_score_, &doubt_, &healthy_}) {
    *v = GetVector(in);
    if (v->size() != n) return false;
  }
  const Eigen::VectorXd packed = GetVector(in);
  if (packed.size() != n * n) return false;
  recent_information_ = packed.reshaped(n, n);
  found_ = in.Get<std::int64_t>();
  if (!candidates_.Restore(in)) return false;
  for (auto left = in.Get<std::uint32_t>(); left > 0 && in.ok(); --left) {
    auto& members = new_classes_[in.Get<int>()];
    for (auto count = in.Get<std::uint32_t>(); count > 0 && count <= kMostMembers && in.ok(); --count)
      members.push_back(GetStroke(in));
  }
  return in.ok();
}

}  // namespace hydroscope::drift
