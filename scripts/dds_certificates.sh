#!/usr/bin/env bash
# Makes what DDS Security wants: an authority, and for each participant a folder that [live.dds] security of its
# machine file names. Only participants whose certificate the same authority signed hear each other; what they
# send is encrypted and signed.
#   scripts/dds_certificates.sh FOLDER NAME...    e.g. scripts/dds_certificates.sh /etc/hydroscope/dds press hydroscope
# FOLDER/authority keeps the authority's key: whoever has it can make further participants. Called again with
# other names it adds these. DAYS (default 3650) and DOMAIN (default 0 to 232, all) may be set in the environment.
set -euo pipefail

if [[ $# -lt 2 ]]; then
  echo "usage: $0 FOLDER NAME..." >&2
  exit 2
fi
folder=$1
shift
days=${DAYS:-3650}
first=${DOMAIN:-0} last=${DOMAIN:-232}
authority=$folder/authority
until=$(date -u -d "+$days days" +%Y-%m-%dT%H:%M:%S)
since=$(date -u -d "-1 day" +%Y-%m-%dT%H:%M:%S)
umask 027
mkdir -p "$authority"

key() { openssl ecparam -name prime256v1 -genkey -noout -out "$1"; }
sign() { openssl smime -sign -in "$1" -text -out "$2" -signer "$authority/ca.pem" -inkey "$authority/key.pem"; }

if [[ ! -f $authority/ca.pem ]]; then
  key "$authority/key.pem"
  openssl req -x509 -new -key "$authority/key.pem" -days "$days" -subj "/O=Hydroscope/CN=DDS authority" \
    -addext basicConstraints=critical,CA:TRUE -out "$authority/ca.pem"
fi

# What holds for everybody in the domain (DDS Security 1.1, 9.4.1.2).
cat > "$authority/governance.xml" <<XML
<?xml version="1.0" encoding="utf-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">
  <domain_access_rules>
    <domain_rule>
      <domains><id_range><min>$first</min><max>$last</max></id_range></domains>
      <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
      <enable_join_access_control>true</enable_join_access_control>
      <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
      <liveliness_protection_kind>SIGN</liveliness_protection_kind>
      <rtps_protection_kind>SIGN</rtps_protection_kind>
      <topic_access_rules>
        <topic_rule>
          <topic_expression>*</topic_expression>
          <enable_discovery_protection>true</enable_discovery_protection>
          <enable_liveliness_protection>true</enable_liveliness_protection>
          <enable_read_access_control>true</enable_read_access_control>
          <enable_write_access_control>true</enable_write_access_control>
          <metadata_protection_kind>NONE</metadata_protection_kind>
          <data_protection_kind>ENCRYPT</data_protection_kind>
        </topic_rule>
      </topic_access_rules>
    </domain_rule>
  </domain_access_rules>
</dds>
XML
sign "$authority/governance.xml" "$authority/governance.smime"

for name in "$@"; do
  own=$folder/$name
  mkdir -p "$own"
  key "$own/key.pem"
  openssl req -new -key "$own/key.pem" -subj "/O=Hydroscope/CN=$name" -out "$own/request.pem"
  openssl x509 -req -in "$own/request.pem" -CA "$authority/ca.pem" -CAkey "$authority/key.pem" -CAcreateserial \
    -days "$days" -out "$own/certificate.pem" 2> /dev/null
  rm "$own/request.pem"
  subject=$(openssl x509 -in "$own/certificate.pem" -noout -subject -nameopt RFC2253 | sed 's/^subject=//')
  # What this participant may do (9.4.1.3); narrow the topics if it shall only read or only write.
  cat > "$own/permissions.xml" <<XML
<?xml version="1.0" encoding="utf-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">
  <permissions>
    <grant name="$name">
      <subject_name>$subject</subject_name>
      <validity><not_before>$since</not_before><not_after>$until</not_after></validity>
      <allow_rule>
        <domains><id_range><min>$first</min><max>$last</max></id_range></domains>
        <publish><topics><topic>*</topic></topics></publish>
        <subscribe><topics><topic>*</topic></topics></subscribe>
      </allow_rule>
      <default>DENY</default>
    </grant>
  </permissions>
</dds>
XML
  sign "$own/permissions.xml" "$own/permissions.smime"
  cp "$authority/ca.pem" "$authority/governance.smime" "$own/"
  echo "security = \"$(realpath "$own")\"   # of $name"
done
