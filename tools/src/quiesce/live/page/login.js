// Hands the token to the server, which keeps it in a cookie. What follows # in an address is sent to nobody.
const said = document.getElementById("said");

async function enter(token) {
  try {
    const answer = await fetch("login", { method: "POST", body: JSON.stringify({ token }) });
    if (answer.ok) {
      location.replace("./");
      return;
    }
    said.textContent = "That is not the token.";
  } catch {
    said.textContent = "The server does not answer.";
  }
}

document.getElementById("login").addEventListener("submit", (event) => {
  event.preventDefault();
  enter(document.getElementById("token").value.trim());
});

const given = new URLSearchParams(location.hash.slice(1)).get("token");
if (given) {
  history.replaceState(null, "", location.pathname);
  enter(given);
}
