import { useState } from "preact/hooks";
import { post } from "../api";
import { failureOf, Problem, type Failure } from "../failure";
import { refresh, useStore } from "../store";
import { useUrl } from "../url_state";
import { useWords } from "../words";

/** Name and password. */
export function Login() {
  const say = useWords();
  const { anyUsers, locked } = useStore();
  const [, setUrl] = useUrl();
  const [name, setName] = useState("");
  const [password, setPassword] = useState("");
  const [problem, setProblem] = useState<Failure | null>(null);
  const [busy, setBusy] = useState(false);
  const login = async (event: Event) => {
    event.preventDefault();
    setBusy(true);
    setProblem(null);
    try {
      await post("login", { name, password });
      if (!locked) setUrl({ view: "" });
      await refresh();
    } catch (caught) {
      setProblem(failureOf(caught));
      setPassword("");
    }
    setBusy(false);
  };
  return (
    <form class="login" onSubmit={(event) => void login(event)}>
      <h1>{say("loginTitle")}</h1>
      <p>{say(locked ? "loginToRead" : "loginToAct")}</p>
      {!anyUsers && <p class="verdict bad">{say("loginNoUsers")} <code class="command">hydroscope users --db … add NAME --role admin</code></p>}
      <label>{say("userName")} <input name="name" autoComplete="username" autoCapitalize="none" spellcheck={false} required maxLength={64} value={name} onInput={(e) => setName(e.currentTarget.value)} /></label>
      <label>{say("password")} <input name="password" type="password" autoComplete="current-password" required maxLength={1024} value={password} onInput={(e) => setPassword(e.currentTarget.value)} /></label>
      <button class="primary" disabled={busy || name === "" || password === ""}>{say("login")}</button>
      <Problem of={problem} />
    </form>
  );
}

/** Who is logged in, and the way in and out. */
export function Account() {
  const say = useWords();
  const [query, setUrl] = useUrl();
  const { session, locked } = useStore();
  if (!session?.login || locked) return null;
  const { user } = session;
  if (!user) return query.view === "login" ? null : <button onClick={() => setUrl({ view: "login" })}>{say("login")}</button>;
  const logout = async () => {
    await post("logout");
    await refresh();
  };
  return <span class="account"><span>{user.name} <small>{say(`role_${user.role}`)}</small></span> <button class="quiet" onClick={() => void logout()}>{say("logout")}</button></span>;
}
