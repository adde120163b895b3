#include "page/work/job_queue.h"

#include <sys/resource.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/json_text.h"
#include "core/told_error.h"
#include "host/progress_listener.h"
#include "page/http/json_reply.h"

namespace hydroscope {
namespace {

constexpr std::size_t kEndedKept = 20;

nlohmann::json JobJson(std::int64_t id, const std::string& kind, const std::string& state,
                       const std::string& what, double share, const Told& error) {
  nlohmann::json json = {{"job", id}, {"kind", kind}, {"state", state}};
  if (state == "running") json.update({{"what", what}, {"share", share}});
  if (state == "failed") json.update(ErrorJson(error));
  return json;
}

}  // namespace

JobQueue::JobQueue(EventFeed& feed, int niceness) : feed_(feed) {
  ListenToProgress([this](const std::string& what, double share) {
    const std::lock_guard lock(mutex_);
    for (Job& job : jobs_) {
      if (job.state != "running" || job.length != Length::kLong) continue;
      job.what = what;
      job.share = share;
      Tell(job);
    }
  });
  threads_ = {std::thread([this, niceness] { Run(Length::kLong, niceness); }),
              std::thread([this] { Run(Length::kShort, 0); })};
}

JobQueue::~JobQueue() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  ListenToProgress({});
}

void JobQueue::Tell(const Job& job) {
  feed_.Publish(JsonText(JobJson(job.id, job.kind, job.state, job.what, job.share, job.error)));
}

Result<std::int64_t> JobQueue::Add(const std::string& kind, const std::string& key,
                                   std::function<Status()> work, Length length) {
  std::int64_t id = 0;
  {
    const std::lock_guard lock(mutex_);
    std::size_t waiting = 0;
    for (Job& job : jobs_) {
      if (job.state != "waiting") continue;
      ++waiting;
      if (job.kind != kind || job.key != key) continue;
      job.work = std::move(work);
      return job.id;
    }
    if (waiting >= kMostWaiting)
      return BadInput(hydroscope::Tell("{} jobs wait already; wait for them",
                                       "{} Arbeiten warten schon; bitte warten", waiting));
    id = ++last_id_;
    jobs_.push_back({id, kind, key, "waiting", "", {}, 0, std::move(work), length});
    Tell(jobs_.back());
  }
  changed_.notify_all();
  return id;
}

nlohmann::json JobQueue::Json() const {
  const std::lock_guard lock(mutex_);
  nlohmann::json out = nlohmann::json::array();
  for (const Job& job : jobs_)
    out.push_back(JobJson(job.id, job.kind, job.state, job.what, job.share, job.error));
  return out;
}

void JobQueue::Run(Length length, int niceness) {
  setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + niceness);  // of this thread
  std::unique_lock lock(mutex_);
  const auto next = [this, length] {
    return std::find_if(jobs_.begin(), jobs_.end(),
                        [length](const Job& job) { return job.state == "waiting" && job.length == length; });
  };
  for (;;) {
    changed_.wait(lock, [&] { return ending_ || next() != jobs_.end(); });
    if (ending_) return;
    Job& job = *next();  // stays where it is: only ended ones in front of it are taken away
    job.state = "running";
    Tell(job);
    const auto work = std::move(job.work);
    lock.unlock();
    const Status done = work();
    lock.lock();
    job.state = done ? "done" : "failed";
    if (!done) job.error = ToldOf(done.error());
    Tell(job);
    while (jobs_.size() > kEndedKept && (jobs_.front().state == "done" || jobs_.front().state == "failed"))
      jobs_.pop_front();
  }
}

}  // namespace hydroscope
